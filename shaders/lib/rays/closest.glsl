// Traces the links of one patch for eight consecutive samples.
#include "lib/link.glsl"
#include "lib/rays/starts.glsl"

vec3 discSample(uint key, uint index) {
    uint seed = discSeed(key, index, push.discCount);
    vec2 point = Vec2s(push.disc).items[discPoint(index, push.discCount, seed)];
    return discDirection(point, push.discCount, seed);
}

vec3 directionOf(uint key, uint index) {
    return push.discCount == 0u ? localDirection(key, index) : discSample(key, index);
}

const uint kSamplesPerInvocation = 8u;

uint linkOfSample(Patch p, PatchCover cover, uint key, uint index) {
    if ((p.flags & kPatchSends) == 0u) return kLinkDark;
    return linkAround(startingPatch(p, cover, index), directionOf(key, index));
}

void traceLinks(uint chunk, uint sampleGroup, uint lane) {
#ifdef TRACER_VOXEL
    if (!voxelsServeSamples(push.firstSample / kSamplesPerInvocation + sampleGroup)) return;
#endif
    uint index = (push.firstChunk + chunk) * kChunk + lane;
    Patch p = loadPatch(push.patches, index);
    uint key = rotationKey(p, loadPatch(push.patches, (push.firstChunk + chunk) * kChunk), push.rotation, push.size);
    PatchCover cover = coverOf(index);
    for (uint k = 0u; k < kSamplesPerInvocation; ++k) {
        uint local = sampleGroup * kSamplesPerInvocation + k;
        WORD_AT(push.links, (chunk * push.sampleCount + local) * kChunk + lane) =
            linkOfSample(p, cover, key, push.firstSample + local);
    }
}
