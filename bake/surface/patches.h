#pragma once

#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/surface/patch_set.h"
#include "bake/surface/texture_group.h"

namespace relume {

class WorkerPool;

struct PatchDesc {
    float reflectivity = 1.0f; // scales the albedo later; their product is clamped to 0.98
    bool rtrad = false;
    // The mesh is part of a scene: it may cover no texel, and scene.texelToPatch covers the group's window.
    bool part = false;
    WorkerPool* pool = nullptr; // where they are built; nullptr: on this thread alone
};

/// Builds the patches of the mesh, which it takes over. The group's window begins with a tile. rtrad means
/// shading normals for everything, no offsets, no back sides, no area correction and albedo as it is. The
/// patches do not depend on the number of threads. Throws Error when no texel is covered, unless desc.part.
PatchSet buildPatches(const Scene& scene, WorldMesh mesh, const TextureGroup& group, const PatchDesc& desc);

/// Returns the bounds of a chunk's patches, without padding.
shader::ChunkBounds chunkBounds(const PatchSet& patches, uint32_t chunk);

} // namespace relume
