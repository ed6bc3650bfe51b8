#pragma once

#include <glm/glm.hpp>

#include "assets/model/scene.h"

namespace relume {

/// Throws UsageError where a coordinate is not finite.
void requirePoint(const glm::vec3& point);
/// The same where it is farther away than things of a scene may be (assets/model/scene_limits.h).
void requirePlace(const glm::vec3& place);

/// The transform with another rotation: from the unturned state about the world's X, then Y, then Z
/// [degrees]. Place, scale, shear and mirroring stay.
glm::mat4 turned(const glm::mat4& transform, const glm::vec3& degrees);

/// A light's transform, shining from where it is at a point [m], its Y axis as far up (+Y) as that goes.
/// Throws Error for point lights, and where it is at that point.
glm::mat4 aimed(const Light& light, const glm::vec3& target);

} // namespace relume
