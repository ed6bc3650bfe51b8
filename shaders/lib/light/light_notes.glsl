// Notes of which analytic lights the rays of a chunk's first sample pass have reached and not reached. A light that all of
// them agree on is asked again in one sample pass of kNoteSamplePasses only; what that finds to be otherwise counts so
// many times, so the mean stays unbiased. push.penumbra is uvec2 per chunk where push.parts is 0: a bit for each
// light that was reached, and one for each that was not; lights beyond kNotedLamps share bits.
const uint kNoteSamplePasses = 8u;
const uint kNotedLamps = 32u;

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer LightNotes { uvec2 items[]; };

bool takesNotes() { return push.penumbra != 0ul && push.parts == 0ul; }

struct LightNote {
    bool known;  // all rays agree, and the light that is seen as a whole is known
    bool asked;  // rays ask nevertheless, or anyway
    float seen;  // 1 or 0, where it is known
};

bool isAsked(uint patchIndex, uint light) { return (hash32(patchIndex * 64u + light) + push.samplePass) % kNoteSamplePasses == 0u; }

// Returns the note on a light, whose bit this is. Patches ask in different sample passes, and for each light in
// others.
LightNote lightNote(uint patchIndex, uint bit, uint light) {
    if (!takesNotes() || push.samplePass == 0u) return LightNote(false, true, 0.0);
    uvec2 lights = LightNotes(push.penumbra).items[patchIndex / kChunk];
    bool reached = (lights.x & bit) != 0u, hidden = (lights.y & bit) != 0u;
    return LightNote(!(reached && hidden), (reached && hidden) || isAsked(patchIndex, light),
                     reached ? 1.0 : 0.0);
}

void takeNote(uint patchIndex, uint reached, uint hidden) {
    if (push.samplePass != 0u) return;
    uint chunk = patchIndex / kChunk;
    if (reached != 0u) atomicOr(LightNotes(push.penumbra).items[chunk].x, reached);
    if (hidden != 0u) atomicOr(LightNotes(push.penumbra).items[chunk].y, hidden);
}
