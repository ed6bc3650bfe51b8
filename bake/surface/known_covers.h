#pragma once

#include <vector>

#include "bake/surface/patch_carry.h"
#include "bake/surface/texture_group.h"

namespace relume {

struct PatchDesc;

/// Tells which parts of texels are covered as they were in a level before it was edited.
struct KnownCovers {
    const PatchSet& former;
    // Per instance, the former one that has the very triangles in the very places of the lightmap; kNoPatch:
    // none.
    std::vector<uint32_t> objects;

    /// Returns the former patch of a texel whose cover is that of this patch; kNoPatch: none is known.
    uint32_t of(const PatchSet& set, uint32_t patch) const;
};

/// Compares the triangles of a mesh of so many instances with those that were baked.
KnownCovers knownCovers(const BakedSurfaces& before, const WorldMesh& mesh, size_t instances);

/// Builds patches as the function of that name in patches.h does, to the bit, and stands beside it. What is
/// known of covers, which take most of the time, is not found out again.
PatchSet buildPatches(const Scene& scene, WorldMesh mesh, const TextureGroup& group, const PatchDesc& desc,
                      const KnownCovers& known);

} // namespace relume
