#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/generate/shapes/solid.h"
#include "assets/generate/shapes/solid_mesh.h"
#include "assets/model/scene.h"

namespace relume::generate {

/// Chart edges fall on multiples of 1 / kAtlasCells of the atlas, and charts are one cell apart: at 128, 256,
/// 512, ... texels no texel is covered by half and patch areas are exact.
constexpr int kAtlasCells = 128;

/// Says where an instance stands: scaled, turned about Y (counter-clockwise seen from above), then moved.
struct Placement {
    glm::dvec3 position{0.0}; // [m]
    double turn = 0.0;        // [degrees]
    glm::dvec3 scale{1.0};
};

/// Tells whether the instances of a mesh are saved together.
enum class Batched { No, Yes };

/// Collects solids, lays their charts out in one lightmap atlas and turns all into a Scene.
class SceneBuilder {
public:
    /// Adds a material of a linear colour and returns its number.
    int paint(const std::string& name, const glm::vec3& color);
    /// Adds a material that emits radiance `emission` [cd/m^2] and is light grey by itself.
    int lamp(const std::string& name, const glm::vec3& emission);
    /// Adds a material whose picture repeats every `tile` metres of ChartVertex::texCoord.
    int textured(const std::string& name, Image image, const glm::dvec2& tile);

    /// Adds a material whose picture has holes (alpha mask) and shows from both sides.
    int masked(const std::string& name, Image image, const glm::dvec2& tile);
    /// Adds glass: blended, of so little alpha that it counts as a pane.
    int glass(const std::string& name, const glm::vec4& color);

    /// Adds an instance with a mesh of its own. Its origin, where an editor would grab it, is `position` [m].
    void add(const std::string& name, Solid solid, const glm::dvec3& position = glm::dvec3(0.0));

    /// Adds a mesh for many instances, which place() adds, and returns its number. `Batched` ones are saved
    /// by EXT_mesh_gpu_instancing.
    int share(const std::string& name, Solid solid, Batched batched = Batched::No);
    void place(int part, const std::string& name, const Placement& placement);
    /// Names the instance after its part, by number.
    void place(int part, const Placement& placement);

    void camera(const std::string& name, const glm::vec3& eye, const glm::vec3& target, float yfovDegrees);

    /// Adds a light at `position` that shines towards `target`; a rectangle's X axis is horizontal.
    void light(Light light, const glm::vec3& position, const glm::vec3& target);
    void sky(const glm::vec3& radiance); // [cd/m^2]

    /// Returns the scene, all instances in one lightmap atlas. Each part must have one instance. Call it
    /// once, last.
    Scene build();
    /// Returns the scene without lightmap UVs. Call it once, last.
    Scene buildWithoutAtlas();

private:
    struct Part {
        std::string name;
        Solid solid;
        std::vector<Instance> instances{};
        Batched batched = Batched::No;
    };

    void layOut();
    Scene assemble(LightmapUvs uvs);

    std::vector<Part> parts_;
    std::vector<glm::dvec2> tiles_; // [m] by material; 0: no texture
    Scene scene_;
};

} // namespace relume::generate
