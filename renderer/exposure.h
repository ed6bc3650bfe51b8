#pragma once

#include <span>

#include <glm/glm.hpp>

namespace relume {

/// The exposure [EV] at which the mean brightness of a picture is a middle grey. Of each cell of the picture:
/// sum of log2(luminance), sum of luminance, number of pixels that have light. 0 for a picture without light.
float automaticExposure(std::span<const glm::vec4> cells);

} // namespace relume
