#pragma once

#include <span>

#include <glm/glm.hpp>

namespace relume {

/// Returns the exposure [EV] at which the mean brightness of a picture is a middle grey; 0 for a picture
/// without light. Each cell of the picture holds the sum of log2(luminance), the sum of luminance and the
/// number of pixels that have light.
float automaticExposure(std::span<const glm::vec4> cells);

} // namespace relume
