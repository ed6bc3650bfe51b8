#pragma once

#include <vector>

#include "bake/base/shader_types.h"
#include "bake/surface/trace_scene.h"

namespace relume {

constexpr uint32_t kTileTexels = 8; // along an edge
/// The largest edge of the sheet of all pages [texels]: texels are numbered by 29 bits in Patch::flags.
constexpr uint32_t kMaxSheetSize = 23168;
static_assert(uint64_t{kMaxSheetSize} * kMaxSheetSize <= uint64_t{1} << (32 - shader::kTexelShift));
static_assert(kMaxSheetSize % kPageStep == 0 && kPageStep % kTileTexels == 0);

/// A patch's own point, from which it looks.
struct OwnPoint {
    uint32_t patch;
    glm::vec3 position;    // [m]
    uint32_t place, cells; // PatchCover's: where in the texel it lies, what it sees of that
    bool sends = false;    // from there
    bool operator==(const OwnPoint&) const = default;
};

/// All patches of a scene in 8x8-texel tile order: geometry and hit tables in `scene`, the rest beside it,
/// one entry per patch, padding included. Patches of objects that were hidden later look like padding.
/// Besides one patch per covered texel there is one for each chart that covers no texel centre (flag
/// kPatchThin), which scene.texelToPatch has where its texel is no other patch's, and one for the back of
/// every texel of a double-sided mesh light (flag kPatchBackSide), which it never has.
struct PatchSet {
    TraceScene scene;
    std::vector<shader::PatchEdges> edges;
    // They tell where samples may start; there are none with rtrad. Cells in front of which something stands
    // are taken away later (bake/validity/cover_search.h); coverCells has them as the surface has them.
    std::vector<shader::PatchCover> covers;
    std::vector<uint32_t> coverCells;
    // These are the points that patches had before they stepped aside, as they lay inside something or upon a
    // surface (bake/validity/step_aside.h); ascending by patch.
    std::vector<OwnPoint> aside;
    std::vector<float> reach; // per chunk: how far samples may start from their patch's own point [m]
    std::vector<shader::ChunkBounds> bounds;               // per chunk
    std::vector<glm::vec4> albedo;                         // a unused
    std::vector<glm::vec4> emission;                       // [cd/m^2], a unused
    std::vector<glm::vec4> albedoPattern, emissionPattern; // the same for factors of 1
    std::vector<uint32_t> material; // into Scene::materials; materials.size(): the default one
    std::vector<uint32_t> instance; // into Scene::instances; of padding instances.size()
    float maxAlbedo = 1.0f;         // albedo is clamped to it
    uint32_t count = 0;             // patches without padding
    uint32_t clampedAlbedo = 0;     // patches whose albedo times reflectivity was above 0.98

    uint32_t chunkCount() const { return scene.chunkCount(); }
};

} // namespace relume
