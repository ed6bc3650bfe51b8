#pragma once

#include <string>

#include "app/live/session.h"

namespace relume {

/// Returns a name from a file, "material 3" where it has none.
std::string nameOf(const std::string& name, const char* kind, size_t index);

/// Returns an instance's name, "instance 3" where the file has none for it.
std::string objectName(const Scene& scene, uint32_t instance);

/// Returns the transform that brings an instance's points from where they were loaded to where the document
/// has them.
glm::mat4 placementOf(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance);
/// Returns the middle of an instance's bounds [m], about which it is turned and which moves along with it, or
/// nothing where it has no triangles.
std::optional<glm::vec3> pivotOf(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance);
/// Returns the bounds of an instance as it is edited [m]; empty where it has no triangles.
Box placedBounds(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance);
/// Returns what normalAt() does, for a surface of the scene as it is edited.
glm::vec3 placedNormalAt(const LoadedScene& scene, const SceneEdits& edits, uint32_t instance,
                         const glm::vec3& position, const glm::vec3& towards);

/// Returns the lengths of a transform's axes, the first below 0 where it mirrors.
glm::vec3 scaleOf(const glm::mat4& transform);
/// Returns what lightAngles() does, for a transform of any scale.
glm::vec3 anglesOf(const glm::mat4& transform);
/// Returns a transform with the same place, scale and shear, turned by these angles [degrees].
glm::mat4 turnedTo(const glm::mat4& transform, const glm::vec3& degrees);
/// Returns a transform with the same place, turn and shear, and another scale. No scale may be 0.
glm::mat4 scaledTo(const glm::mat4& transform, const glm::vec3& scale);

/// An instance that the gizmo moves from where `begin` has it.
struct MovedObject {
    const LoadedScene& scene;
    uint32_t instance = 0;
    glm::mat4 begin{1.0f};
};
/// Returns its transform when it touches a surface from the side of `normal` (unit), with its middle above
/// `position`.
glm::mat4 restingOn(const MovedObject& object, const glm::vec3& position, const glm::vec3& normal);

} // namespace relume
