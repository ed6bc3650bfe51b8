// Sampling a group of analytic lights and gathering their light share this: both draw the same rays.
#include "lib/preamble.glsl"
#include "lib/sampling.glsl"
#include "lib/form_factor.glsl"
#include "lib/light/polygon_sample.glsl"
layout(constant_id = 0) const uint kLampTypes = 0x3fu;
#define LAMP_TYPES kLampTypes
layout(push_constant, scalar) uniform Push { LampPush push; };
#define LISTED_INSTEAD push.patches
#include "lib/listed_chunk.glsl"
#include "lib/rays/starts.glsl"
#include "lib/light/texel_mean.glsl"
#include "lib/light/lamps.glsl"
#include "lib/light/penumbra_sample_passes.glsl"
vec4 skyPixel(uint index) { return VEC4_AT(push.sky, index); }
float skyRow(uint index) {
    uint pixels = (push.skySize & 0xffffu) * (push.skySize >> 16);
    return FLOAT_AT(push.sky + 16ul * uint64_t(pixels), index);
}
#include "lib/light/sky.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Lamps { Lamp items[]; };
// Its samples are those of all sample passes that are taken together; a light of one sample has the same one in each.
Lamp loadLamp(uint indexInGroup) {
    Lamp l = Lamps(push.lamps).items[push.firstLamp + indexInGroup];
    if (l.samples > 1u) l.samples *= push.together;
    l.firstTarget *= push.together;
    return l;
}
uint targetsOf(Lamp l) { return max(l.samples, push.together); }
uint takenSamples(Lamp l, uint takenSamplePasses) {
    return l.samples > 1u ? l.samples / push.together * takenSamplePasses : min(takenSamplePasses, 1u);
}

uint lampCount() { return push.counts & 0xffffu; }
uint targetCount() { return push.counts >> 16; }

struct LampRay {
    vec3 target;
    vec3 light; // unshadowed, per unit of the light's colour; the mean over its samples counts
    bool traced;
};

// Holds a patch with the part of its texel that its samples start from.
struct Receiver {
    Patch p;
    PatchCover cover;
    TexelSpread spread;
};
Receiver receiver(uint patchIndex) {
    Receiver r;
    r.p = loadPatch(push.patches, patchIndex);
    r.cover = coverOf(patchIndex);
    r.spread = texelSpread(r.p, r.cover);
    return r;
}

// Makes sample s of a receiver, which starts at another point of its texel. skySize is that of the sky's picture, 0:
// none.
LampRay lampRayUnder(uvec2 skySize, Lamp l, Receiver r, uint s) {
    uint number = push.samplePass * l.samples + s, index = replicateIndex(number);
    Patch p = startingPatch(r.p, r.cover, number);
    uint seed = lampSeed(l, seedKey(p), number);
    LampRay ray;
    if (isLamp(l, kLampSky)) {
        // With a picture, samples come in pairs, one by each way, that share their numbers.
        uint turn = skySize.x > 0u ? index / 2u : index;
        SkySample sky = skySample(p, sobolPoint(turn, seed), index % 2u != 0u, skySize, push.skyRotation);
        ray.target = p.position + push.reach * sky.direction;
        ray.light = sky.light;
    } else {
        vec3 fading = fadingPlace(lampUnevenness(l, r.spread.middle, r.spread.size), r.spread.middle, p.position);
        LampSample point = lampSample(l, p, fading, sobolPoint(index, seed), push.reach);
        ray.target = point.target;
        ray.light = vec3(point.factor);
    }
    // Below the geometric horizon the end is hidden, and not asked for.
    ray.traced = ray.light != vec3(0.0) && (p.flags & kPatchSends) != 0u && dot(ray.target - p.position, p.normal) > p.offset;
    return ray;
}

LampRay lampRay(Lamp l, Receiver r, uint s) {
    return lampRayUnder(uvec2(push.skySize & 0xffffu, push.skySize >> 16), l, r, s);
}

// Returns the bit of a light in notes and penumbrae.
uint lampBit(uint indexInGroup) {
    return push.parts == 0ul ? 1u << ((push.firstLamp + indexInGroup) % kNotedLamps) : 1u << (indexInGroup % 32u);
}

// Returns the light of a whole one, unshadowed, per unit of its colour; negative where only samples tell.
vec3 wholeLight(Lamp l, Receiver r) {
    if (isLamp(l, kLampSky) && push.skySize == 0u) return lampRayUnder(uvec2(0u), l, r, 0u).light;
    return vec3(lampWhole(l, r.spread, r.p.shading));
}

// A light that brings a patch no more than this share of its direct light is asked in one sample pass of
// kNoteSamplePasses, too: its noise is small whatever is in its way.
const float kMinorShare = 0.01;

LightNote lampNote(Lamp l, Receiver r, uint patchIndex, uint indexInGroup) {
    uint light = push.firstLamp + indexInGroup;
    LightNote note = lightNote(patchIndex, lampBit(indexInGroup), light);
    if (!takesNotes() || push.samplePass == 0u || note.known || l.samples == 1u) return note;
    vec3 whole = wholeLight(l, r) * l.color, soFar = VEC4_AT(push.direct, patchIndex).rgb;
    bool minor = whole.r >= 0.0 && whole.r + whole.g + whole.b <= kMinorShare * (soFar.r + soFar.g + soFar.b);
    return minor ? LightNote(true, isAsked(patchIndex, light), 0.0) : note;
}
