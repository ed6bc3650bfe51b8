#pragma once

#include <optional>
#include <utility>

#include <glm/glm.hpp>

#include "renderer/camera.h"

namespace relume {

/// A picture of a scene, and points of it: from its upper left corner, in whatever unit its size has.
struct ScreenView {
    ViewCamera camera;
    glm::vec2 size{1.0f}; // above 0
};

struct ScreenRay {
    glm::vec3 origin{0.0f}, direction{0.0f}; // [m], unit
    glm::vec3 at(float distance) const { return origin + distance * direction; }
};

/// What is seen at a point lies along it.
ScreenRay rayThrough(const ScreenView& view, const glm::vec2& point);
/// None: beside or behind the eye, nearer than the camera sees.
std::optional<glm::vec2> project(const ScreenView& view, const glm::vec3& position);
/// Ends of what is seen of a straight line; it may leave the picture. None: all of it is behind the eye.
std::optional<std::pair<glm::vec2, glm::vec2>> projectLine(const ScreenView& view, const glm::vec3& from,
                                                           const glm::vec3& to);
/// What a length of 1 on the picture is as far away as this position [m].
float lengthOnScreen(const ScreenView& view, const glm::vec3& position);
/// From a position to the eye; unit.
glm::vec3 towardsEye(const ViewCamera& camera, const glm::vec3& position);

} // namespace relume
