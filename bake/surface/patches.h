#pragma once

#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/surface/patch_set.h"
#include "bake/surface/texture_group.h"

namespace relume {

struct PatchDesc {
    float reflectivity = 1.0f; // scales the albedo later; their product is clamped to 0.98
    bool rtrad = false;
    // Of a scene: it may cover no texel, and scene.texelToPatch is of the group's window.
    bool part = false;
};

/// Takes over the mesh. The group's window begins with a tile. rtrad: shading normals for everything, no
/// offsets, no back sides, no area correction, albedo as it is. Throws Error when no texel is covered.
PatchSet buildPatches(const Scene& scene, WorldMesh mesh, const TextureGroup& group, const PatchDesc& desc);

/// Of a chunk's patches that are there.
shader::ChunkBounds chunkBounds(const PatchSet& patches, uint32_t chunk);

/// Whether a patch lies inside something, by what so many of its directions meet: two of five backs at least,
/// and more of them than fronts.
bool liesInside(uint32_t backs, uint32_t sky, uint32_t sampleCount);

} // namespace relume
