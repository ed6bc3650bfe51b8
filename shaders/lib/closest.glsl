// Links of one patch for eight consecutive samples.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer HitTriangles { HitTriangle items[]; };

uint texelPatch(uint texel) { return Words(push.texelToPatch).items[texel]; }
uint chartOfPatch(uint index) { return Words(push.patchChart).items[index]; }
#include "lib/hit.glsl"

uint linkOf(Hit found, vec3 direction) {
    if (found.triangle == kNoPatch) return kLinkSky;
    HitTriangle t = HitTriangles(push.hitTriangles).items[found.triangle];
    if (dot(direction, t.normal) > 0.0) return t.doubleSided != 0u ? kLinkDark : kLinkBack;
    if (t.representative == kNoPatch) return kLinkDark;
    return patchAtHit(t, found.b1, found.b2, push.size);
}

const uint kSamplesPerInvocation = 8u;

void traceLinks(uint chunk, uint sampleGroup, uint lane) {
    uint index = (push.firstChunk + chunk) * kChunk + lane;
    Patch p = loadPatch(push.patches, index);
    uint key = seedKey(p);
    if (push.perTile != 0u) key = seedKey(loadPatch(push.patches, (push.firstChunk + chunk) * kChunk));
    vec3 origin = p.position + p.offset * p.normal;
    for (uint k = 0u; k < kSamplesPerInvocation; ++k) {
        uint local = sampleGroup * kSamplesPerInvocation + k;
        uint link = kLinkDark;
        if ((p.flags & kPatchSends) != 0u) {
            vec3 direction = patchDirection(p, key, push.firstSample + local);
            link = linkOf(closestHit(origin, direction), direction);
        }
        Words(push.links).items[(chunk * push.sampleCount + local) * kChunk + lane] = link;
    }
}
