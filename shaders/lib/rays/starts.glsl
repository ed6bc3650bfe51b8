// Moves patches to where their samples start; push.covers is PatchCover[], or 0 where they stay.
#include "lib/rays/start_point.glsl"

// Returns the cover of a patch. It is loaded once for all of its samples: that costs software devices more
// than the points do.
PatchCover coverOf(uint patchIndex) {
    PatchCover none = PatchCover(vec3(0.0), 0u, vec3(0.0), 0u), cover = none;
    if (readsAny(push.covers)) // and else nothing, as vec4IfAny() does
        cover = loadCover(readable(push.covers, push.patches), readableAt(push.covers, patchIndex));
    if (push.covers == 0ul) cover = none;
    return cover;
}

// Returns the patch as sample `number` sees it.
Patch startingPatch(Patch p, PatchCover cover, uint number) {
    p.position = startPoint(p, cover, number);
    return p;
}
