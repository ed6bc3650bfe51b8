#include "assets/model/black_body.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// Returns the chromaticity (u, v) of CIE 1960 at a temperature t [K] [Krystek 1985, An algorithm to calculate
// correlated colour temperature], good to 9e-5 from 1000 to 15000 K.
glm::dvec2 planckianLocus(double t) {
    return {(0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) /
                (1.0 + 8.42420235e-4 * t + 7.08145163e-7 * t * t),
            (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) /
                (1.0 - 2.89741816e-5 * t + 1.61456053e-7 * t * t)};
}

} // namespace

glm::vec3 blackBody(float kelvin) {
    const glm::dvec2 uv = planckianLocus(std::clamp(kelvin, kLowestTemperature, kHighestTemperature));
    const double scale = 2.0 * uv.x - 8.0 * uv.y + 4.0;
    const double x = 3.0 * uv.x / scale, y = 2.0 * uv.y / scale;
    const glm::dvec3 xyz(x / y, 1.0, (1.0 - x - y) / y);
    // This matrix is that of IEC 61966-2-1.
    const glm::dvec3 rgb(3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
                         -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
                         0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z);
    return glm::vec3(glm::max(rgb, 0.0) / std::max({rgb.r, rgb.g, rgb.b}));
}

std::optional<NearestBody> nearestBlackBody(const glm::vec3& color) {
    const float most = std::max({color.r, color.g, color.b});
    if (!(most > 0.0f) || !std::isfinite(color.r + color.g + color.b)) return std::nullopt;
    const glm::vec3 wanted = glm::max(color, 0.0f) / most;
    const auto difference = [&](float reciprocal) { return blackBody(1.0f / reciprocal) - wanted; };
    // Colours change evenly along the reciprocal temperature [Judd 1936]; between a red and a blue there is
    // one nearest place, which a ternary search finds.
    float low = 1.0f / kHighestTemperature, high = 1.0f / kLowestTemperature;
    constexpr float kExact = 1e-9f; // [1/K], 0.04 K at 6500 K
    while (high - low > kExact) {
        const float third = (high - low) / 3.0f, a = low + third, b = high - third;
        const glm::vec3 atA = difference(a), atB = difference(b);
        if (glm::dot(atA, atA) < glm::dot(atB, atB))
            high = b;
        else
            low = a;
    }
    const float reciprocal = 0.5f * (low + high);
    const glm::vec3 off = glm::abs(difference(reciprocal));
    return NearestBody{1.0f / reciprocal, std::max({off.r, off.g, off.b})};
}

} // namespace relume
