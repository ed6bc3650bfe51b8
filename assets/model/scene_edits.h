#pragma once

#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Says where an instance stands.
struct Placement {
    glm::mat4 transform{1.0f}; // object to world
    bool hidden = false;

    bool operator==(const Placement&) const = default;
};

/// Holds the parts of a scene that users edit live; all else stays as its file has it.
struct SceneEdits {
    std::vector<Material> materials; // as many as the scene's
    std::vector<Light> lights;
    SkySettings sky;
    std::vector<Placement> placements; // of the scene's instances
    std::vector<float> densities;      // of the scene's instances; they count when the scene is read again
};

/// Returns these parts as the scene has them.
SceneEdits editsOf(const Scene& scene);
/// Changes the scene as the edits say. `scene` has the materials and instances that they began with. Where
/// the sky has another picture than before, only its name is taken (see readEditedPicture).
void applyEdits(Scene& scene, const SceneEdits& edits);

} // namespace relume
