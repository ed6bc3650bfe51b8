#pragma once

#include <vector>

#include "assets/world_mesh.h"
#include "bake/shader_types.h"

namespace relume {

/// All that shines without geometry, as shaders/lib/lamps.glsl and sky.glsl sample it. Lights of no intensity
/// are left out.
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

/// samples: rays to each lamp that has an extent, per patch and round; a multiple of 2 * shader::kReplicates.
LampSet buildLamps(const Scene& scene, const WorldMesh& mesh, uint32_t samples);

} // namespace relume
