#pragma once

#include <vector>

#include "assets/world_mesh.h"
#include "bake/shader_types.h"
#include "bake/texture_group.h"
#include "bake/trace/trace_scene.h"

namespace relume {

/// All patches of a scene in 8x8-texel tile order: geometry and hit tables in `scene`, the rest beside it,
/// one entry per patch, padding included. Patches of
/// objects that were hidden later are as padding. Besides one patch per covered texel there is one for each
/// chart that covers no texel centre, and one for the back of every texel of a double-sided emitter (flag
/// kPatchBackSide); neither is in scene.texelToPatch.
struct PatchSet {
    TraceScene scene;
    std::vector<shader::PatchEdges> edges;
    std::vector<shader::ChunkBounds> bounds;               // per chunk
    std::vector<glm::vec4> albedo;                         // a unused
    std::vector<glm::vec4> emission;                       // [cd/m^2], a unused
    std::vector<glm::vec4> albedoPattern, emissionPattern; // the same for factors of 1
    std::vector<uint32_t> material; // into Scene::materials; materials.size(): the default one
    std::vector<uint32_t> instance; // into Scene::instances; of padding instances.size()
    float maxAlbedo = 1.0f;         // that albedo is clamped to
    uint32_t count = 0;             // patches without padding
    uint32_t clampedAlbedo = 0;     // patches whose albedo times reflectivity was above 0.98

    uint32_t chunkCount() const { return scene.chunkCount(); }
};

struct PatchDesc {
    float reflectivity = 1.0f; // scales the albedo later; their product is clamped to 0.98
    bool rtrad = false;
    // Of a scene: it may cover no texel, and scene.texelToPatch is of the group's window.
    bool part = false;
};

constexpr uint32_t kTileTexels = 8; // along an edge

/// Takes over the mesh. The group's window begins with a tile. rtrad: shading normals for everything, no
/// offsets, no back sides, no area correction, albedo as it is. Throws Error when no texel is covered.
PatchSet buildPatches(const Scene& scene, WorldMesh mesh, const TextureGroup& group, const PatchDesc& desc);

/// Of a chunk's patches that are there.
shader::ChunkBounds chunkBounds(const PatchSet& patches, uint32_t chunk);

/// Sets albedo and emission to these factors times the patterns.
void applyMaterials(PatchSet& patches, const std::vector<Material>& materials);

/// Whether a patch lies inside something, by what so many of its directions meet: two of five backs at least,
/// and more of them than fronts.
bool liesInside(uint32_t backs, uint32_t sky, uint32_t sampleCount);

} // namespace relume
