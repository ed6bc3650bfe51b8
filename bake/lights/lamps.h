#pragma once

#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/base/shader_types.h"

namespace relume {

/// All analytic lights, as shaders/lib/light/lamps.glsl and sky.glsl sample them. Lights of no intensity are
/// left out.
struct LampSet {
    std::vector<shader::Lamp> lamps; // the sky, where it shines, is the last one
    std::vector<glm::vec4>
        skyPixels; // [height][width]: radiance, and the share of its row up to and with the pixel
    std::vector<float> skyRows; // share of all rows up to and with this one; empty: one radiance
    glm::uvec2 skySize{0};
    float skyRotation = 0; // [rad]
    float reach = 0;       // [m], out of the scene from anywhere in it

    bool empty() const { return lamps.empty(); }
};

struct LampDesc {
    uint32_t samples = 16; // rays to each light that has an extent, per patch and sample pass; a multiple of
                           // 2 * shader::kReplicates
    uint32_t pointSamples = 1; // to each of the others: 1, or a multiple of shader::kReplicates
    bool sky = true;           // the sky is among them
    bool unit = false;         // every light shines with colour 1, those of no intensity too
};
LampSet buildLamps(const Scene& scene, const WorldMesh& mesh, const LampDesc& desc);
/// Returns LampSet::reach for these triangles.
float reachOf(const WorldMesh& mesh);
/// Returns only the analytic lights of such a set, whose sky is as it was made.
std::vector<shader::Lamp> lampsOf(const Scene& scene, bool skyShines, const LampDesc& desc);

} // namespace relume
