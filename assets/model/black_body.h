#pragma once

#include <optional>

#include <glm/glm.hpp>

namespace relume {

constexpr float kLowestTemperature = 1000.0f, kHighestTemperature = 15000.0f; // [K]

/// Returns the colour of a black body in linear sRGB with its largest channel at 1; what lies outside of sRGB
/// (below 1900 K) is cut off. The temperature [K] is clamped to the range above.
glm::vec3 blackBody(float kelvin);

/// Tells which black body's colour is nearest to another one.
struct NearestBody {
    float kelvin = 0.0f;
    float off = 0.0f; // largest difference of a channel, as a share of the largest channel
};
/// Finds the black body nearest to a linear colour of any brightness. Returns none for black, or where it is
/// no number.
std::optional<NearestBody> nearestBlackBody(const glm::vec3& color);

} // namespace relume
