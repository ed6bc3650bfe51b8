#pragma once

#include <glm/glm.hpp>

#include "assets/model/scene.h"

namespace relume {

/// Throws UsageError where a coordinate is not finite.
void requirePoint(const glm::vec3& point);
/// Does the same, and where a coordinate is farther away than things of a scene may be
/// (assets/model/scene_limits.h).
void requirePlace(const glm::vec3& place);

/// Returns the transform with another rotation: from the unturned state about the world's X, then Y, then Z
/// [degrees]. Place, scale, shear and mirroring stay.
glm::mat4 turned(const glm::mat4& transform, const glm::vec3& degrees);

/// Returns a light's transform that shines from where it is at a point [m], with its Y axis as far up (+Y) as
/// that goes. Throws Error for point lights, and where the light is at that point.
glm::mat4 aimed(const Light& light, const glm::vec3& target);

} // namespace relume
