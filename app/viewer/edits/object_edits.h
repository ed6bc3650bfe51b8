#pragma once

#include <string>

#include "app/live/session.h"

namespace relume {

/// A name from a file, "material 3" where it has none.
std::string nameOf(const std::string& name, const char* kind, size_t index);

/// "instance 3" where the file has no name for it.
std::string objectName(const Scene& scene, uint32_t instance);

/// What brings an instance's points from where they were loaded to where the document has them.
glm::mat4 placementOf(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance);
/// Middle of what there is of an instance, about which it is turned: moves along with it [m]. none: it has no
/// triangles.
std::optional<glm::vec3> pivotOf(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance);
/// Of a surface of the scene as it is edited, as normalAt() has it.
glm::vec3 placedNormalAt(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance,
                         const glm::vec3& position, const glm::vec3& towards);

/// Lengths of a transform's axes, the first below 0 where it mirrors.
glm::vec3 scaleOf(const glm::mat4& transform);
/// As lightAngles(), of any scale.
glm::vec3 anglesOf(const glm::mat4& transform);
/// The same place, scale and shear, turned so [degrees].
glm::mat4 turnedTo(const glm::mat4& transform, const glm::vec3& degrees);
/// The same place, turn and shear. No scale may be 0.
glm::mat4 scaledTo(const glm::mat4& transform, const glm::vec3& scale);

/// An instance on its way by the gizmo, from where `begin` has it.
struct MovedObject {
    const LoadedScene& scene;
    uint32_t instance = 0;
    glm::mat4 begin{1.0f};
};
/// Its transform when it touches a surface from the side of `normal` (unit), its middle above `position`.
glm::mat4 restingOn(const MovedObject& object, const glm::vec3& position, const glm::vec3& normal);

} // namespace relume
