#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/world_mesh.h"
#include "assets/model/scene.h"
#include "bake/base/shader_types.h"

namespace relume {

/// Holds what a surface is painted with in one place, for factors of 1.
struct SurfaceColour {
    glm::vec4 albedo{0.0f}, emission{0.0f};
};

/// Reads a mesh's textures on the CPU: the nearest texel, as the tracers' alpha test does. Places in a
/// triangle are the weights of its corners.
class SurfaceReader {
public:
    /// Scene and mesh must outlive it.
    SurfaceReader(const Scene& scene, const WorldMesh& mesh);

    SurfaceColour colourAt(uint32_t triangle, const glm::vec3& weights) const;
    /// Tells whether a ray that meets a masked triangle there stops.
    bool isSolid(uint32_t triangle, const glm::vec3& weights) const;
    /// Returns how many texels of its mask an edge in a masked triangle spans; the edge is a difference of
    /// weights.
    double maskTexels(uint32_t triangle, const glm::dvec3& edge) const;

private:
    struct Mask {
        shader::AlphaMaterial material{};
        const Image* image = nullptr;
    };
    glm::vec4 texelAt(const TextureRef& ref, const glm::vec2& uv, bool srgb) const;

    const Scene& scene_;
    const WorldMesh& mesh_;
    std::vector<Material> materials_;
    std::vector<Mask> masks_;         // per material
    std::array<float, 256> linear_{}; // of sRGB bytes
};

} // namespace relume
