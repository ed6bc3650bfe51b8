// Links of one patch for eight consecutive samples.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer HitTriangles { HitTriangle items[]; };

uint texelPatch(uint texel) { return Words(push.texelToPatch).items[texel]; }
uint chartOfPatch(uint index) { return Words(push.patchChart).items[index]; }
#ifdef TRACER_VOXEL
uint closestLink(Patch p, vec3 direction) { return voxelLink(p, direction); }
#else
#include "lib/hit.glsl"

uint linkOf(Hit found, vec3 direction) {
    if (found.triangle == kNoPatch) return kLinkSky;
    HitTriangle t = HitTriangles(push.hitTriangles).items[found.triangle];
    if (dot(direction, t.normal) > 0.0) return t.doubleSided != 0u ? kLinkDark : kLinkBack;
    if (t.representative == kNoPatch) return kLinkDark;
    return patchAtHit(t, found.b1, found.b2, push.size);
}

uint closestLink(Patch p, vec3 direction) {
    return linkOf(closestHit(p.position + p.offset * p.normal, direction), direction);
}
#endif

vec3 discSample(uint key, uint index) {
    uint seed = discSeed(key, index, push.discCount);
    vec2 point = Vec2s(push.disc).items[discPoint(index, push.discCount, seed)];
    return discDirection(point, push.discCount, seed);
}

vec3 directionOf(Patch p, uint key, uint index) {
    return push.discCount == 0u ? patchDirection(p, key, index) : aroundPatch(p, discSample(key, index));
}

const uint kSamplesPerInvocation = 8u;

uint linkOfSample(Patch p, uint key, uint index) {
    if ((p.flags & kPatchSends) == 0u) return kLinkDark;
    return closestLink(p, directionOf(p, key, index));
}

void traceLinks(uint chunk, uint sampleGroup, uint lane) {
#ifdef TRACER_VOXEL
    if (!voxelsServeSamples(push.firstSample / kSamplesPerInvocation + sampleGroup)) return;
#endif
    uint index = (push.firstChunk + chunk) * kChunk + lane;
    Patch p = loadPatch(push.patches, index);
    uint key = rotationKey(p, loadPatch(push.patches, (push.firstChunk + chunk) * kChunk), push.rotation, push.size);
    for (uint k = 0u; k < kSamplesPerInvocation; ++k) {
        uint local = sampleGroup * kSamplesPerInvocation + k;
        Words(push.links).items[(chunk * push.sampleCount + local) * kChunk + lane] =
            linkOfSample(p, key, push.firstSample + local);
    }
}
