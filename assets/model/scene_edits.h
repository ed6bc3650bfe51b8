#pragma once

#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Where an instance stands.
struct Placement {
    glm::mat4 transform{1.0f}; // object to world
    bool hidden = false;

    bool operator==(const Placement&) const = default;
};

/// What of a scene users edit live; all else stays as its file has it.
struct SceneEdits {
    std::vector<Material> materials; // as many as the scene's
    std::vector<Light> lights;
    SkySettings sky;
    std::vector<Placement> placements; // of the scene's instances
};

/// As the scene has it.
SceneEdits editsOf(const Scene& scene);
/// Makes the scene as the edits say. `scene` has the materials and instances that they began with. Of another
/// sky picture than its own it takes nothing but the name (readEditedPicture).
void applyEdits(Scene& scene, const SceneEdits& edits);

} // namespace relume
