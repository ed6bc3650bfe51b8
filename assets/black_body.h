#pragma once

#include <glm/glm.hpp>

namespace relume {

// A dull glow, and beyond the bluest sky, where the colour hardly changes any more [K].
constexpr float kColdestBlackBody = 1000.0f, kHottestBlackBody = 40000.0f;

/// The colour of a black body of this temperature [K], kColdestBlackBody to kHottestBlackBody: linear, with
/// the primaries of sRGB, the brightest channel 1. What is outside their gamut (below 1900 K) has 0 for the
/// channel that would be negative.
glm::vec3 blackBodyColor(float kelvin);

} // namespace relume
