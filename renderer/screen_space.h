#pragma once

#include <optional>
#include <utility>

#include <glm/glm.hpp>

#include "renderer/camera.h"

namespace relume {

/// Describes a picture of a scene. Points of it are counted from its upper left corner, in whatever unit its
/// size has.
struct ScreenView {
    ViewCamera camera;
    glm::vec2 size{1.0f}; // above 0
};

struct ScreenRay {
    glm::vec3 origin{0.0f}, direction{0.0f}; // [m], unit
    glm::vec3 at(float distance) const { return origin + distance * direction; }
};

/// Returns the ray along which what is seen at a point lies.
ScreenRay rayThrough(const ScreenView& view, const glm::vec2& point);
/// Projects a position onto the picture. Returns none where it is beside or behind the eye, or nearer than
/// the camera sees.
std::optional<glm::vec2> project(const ScreenView& view, const glm::vec3& position);
/// Returns the ends of what is seen of a straight line, which may leave the picture, or none where all of it
/// is behind the eye.
std::optional<std::pair<glm::vec2, glm::vec2>> projectLine(const ScreenView& view, const glm::vec3& from,
                                                           const glm::vec3& to);
/// Returns what a length of 1 on the picture is [m] as far away as this position.
float lengthOnScreen(const ScreenView& view, const glm::vec3& position);
/// Returns the unit direction from a position to the eye.
glm::vec3 towardsEye(const ViewCamera& camera, const glm::vec3& position);

} // namespace relume
