// Moves patches to where their samples start; push.covers is PatchCover[], or 0 where they stay.
#include "lib/rays/start_point.glsl"

// Returns the cover of a patch. It is loaded once for all of its samples: that costs software devices more
// than the points do.
PatchCover coverOf(uint patchIndex) {
    if (push.covers != 0ul) return loadCover(push.covers, patchIndex);
    return PatchCover(vec3(0.0), 0u, vec3(0.0), 0u);
}

// Returns the patch as sample `number` sees it.
Patch startingPatch(Patch p, PatchCover cover, uint number) {
    p.position = startPoint(p, cover, number);
    return p;
}
