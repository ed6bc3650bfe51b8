// Moves patches to where their samples start; push.covers is PatchCover[], or 0 where they stay.
#include "lib/rays/start_point.glsl"

// Returns the cover of a patch. It is loaded once for all of its samples: that costs software devices more
// than the points do.
PatchCover coverOf(uint patchIndex) {
    bool any = push.covers != 0ul; // something is read in any case, as by vec4IfAny()
    PatchCover cover = loadCover(any ? push.covers : push.patches, any ? patchIndex : 0u);
    if (!any) cover = PatchCover(vec3(0.0), 0u, vec3(0.0), 0u);
    return cover;
}

// Returns the patch as sample `number` sees it.
Patch startingPatch(Patch p, PatchCover cover, uint number) {
    p.position = startPoint(p, cover, number);
    return p;
}
