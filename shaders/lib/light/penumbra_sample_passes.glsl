// Tells which patches take part in push.samplePass of direct light; with push.penumbra 0, or notes of each patch
// (lib/light/light_notes.glsl), all do.
#include "lib/light/penumbra.glsl"
#include "lib/light/light_notes.glsl"

bool samplePassLeftOut(uint patchIndex) {
    return push.penumbra != 0ul && push.parts != 0ul && !allTakeSamplePass(push.samplePass) && !inPenumbra(patchIndex);
}

// Notes in the first sample pass what the others are to do; bit i is for the lights i % 32.
void noteLights(uint patchIndex, uint reached, uint hidden) {
    if (push.penumbra == 0ul || push.samplePass != 0u) return;
    if (push.parts == 0ul) {
        takeNote(patchIndex, reached, hidden);
        return;
    }
    uint part = WORD_AT(push.parts, patchIndex);
    uvec2 lights = Penumbrae(push.penumbra).items[part];
    if ((reached & ~lights.x) != 0u) atomicOr(Penumbrae(push.penumbra).items[part].x, reached);
    if ((hidden & ~lights.y) != 0u) atomicOr(Penumbrae(push.penumbra).items[part].y, hidden);
}
