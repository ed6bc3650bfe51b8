// Tells what a ray from a patch meets, as a link. The includer's push constants have the tables.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer HitTriangles { HitTriangle items[]; };

uint texelPatch(uint texel) { return WORD_AT(push.texelToPatch, texel); }
uint chartOfPatch(uint index) { return WORD_AT(push.patchChart, index); }
#ifdef TRACER_VOXEL
uint closestLink(Patch p, vec3 direction) { return voxelLink(p, direction); }
#else
#include "lib/rays/hit.glsl"

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

// Returns the link of a direction that is given around +z.
uint linkAround(Patch p, vec3 local) {
    uint link = closestLink(p, aroundPatch(p, local));
    return link == kLinkSky && mirroredUp(p, local) ? kLinkSkyBelow : link;
}
