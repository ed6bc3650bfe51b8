#pragma once

#include <optional>

#include "assets/survey/level_rays.h"

namespace relume {

/// Somewhere to stand in a level, and where to look from there.
struct StandingView {
    glm::vec3 eye{0.0f}, target{0.0f}; // [m]
    float score = 0.0f;                // above 0; the better, the more it shows
};

constexpr float kStandingFov = 1.0f; // [rad], of a standing view's height

/// Returns the best view of somebody who stands on the ground of a level outdoors, in streets or squares with
/// walls around: much to be seen, at many distances, and nothing right before the eye. Returns nothing where
/// there is no such ground, as in an interior, on a terrain or around an object that stands alone.
std::optional<StandingView> standingView(const LevelRays& rays, const glm::vec3& low, const glm::vec3& high,
                                         float aspect);

} // namespace relume
