#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/generate_solid.h"
#include "assets/model/scene.h"

namespace relume::generate {

/// Chart edges fall on multiples of 1 / kAtlasCells of the atlas, and charts are one cell apart: at 128, 256,
/// 512, ... texels no texel is covered by half and patch areas are exact.
constexpr int kAtlasCells = 128;

/// Collects solids, lays their charts out in one lightmap atlas and turns all into a Scene.
class SceneBuilder {
public:
    /// Adds a material of a linear colour and returns its number.
    int paint(const std::string& name, const glm::vec3& color);
    /// Adds a material that emits radiance `emission` [cd/m^2] and is light grey by itself.
    int lamp(const std::string& name, const glm::vec3& emission);
    /// Adds a material whose picture repeats every `tile` metres of ChartVertex::texCoord.
    int textured(const std::string& name, Image image, const glm::dvec2& tile);

    /// Adds an instance with a mesh of its own. Its origin, where an editor would grab it, is `position` [m].
    void add(const std::string& name, Solid solid, const glm::dvec3& position = glm::dvec3(0.0));

    void camera(const std::string& name, const glm::vec3& eye, const glm::vec3& target, float yfovDegrees);

    /// Adds a light at `position` that shines towards `target`; a rectangle's X axis is horizontal.
    void light(Light light, const glm::vec3& position, const glm::vec3& target);
    void sky(const glm::vec3& radiance); // [cd/m^2]

    /// Returns the scene. Call it once, last.
    Scene build();

private:
    struct Part {
        std::string name;
        Solid solid;
        glm::dvec3 position;
    };

    void layOut();
    Mesh makeMesh(const Part& part) const;

    std::vector<Part> parts_;
    std::vector<glm::dvec2> tiles_; // [m] by material; 0: no texture
    Scene scene_;
};

} // namespace relume::generate
