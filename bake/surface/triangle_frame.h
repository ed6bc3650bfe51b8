#pragma once

#include "assets/atlas/world_mesh.h"

namespace relume {

/// The affine map from the lightmap to the world that a triangle defines.
struct TriangleFrame {
    glm::vec3 normal{0.0f};       // geometric, unit
    glm::vec3 du{0.0f}, dv{0.0f}; // [m] per texel; zero where the UVs are degenerate
    float area = 0.0f;            // [m^2]
};

/// Returns a triangle's, in a lightmap with this edge [texels].
TriangleFrame triangleFrame(const WorldMesh& mesh, uint32_t triangle, uint32_t size);

} // namespace relume
