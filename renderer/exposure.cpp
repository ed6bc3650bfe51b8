#include "renderer/exposure.h"

#include <algorithm>
#include <cmath>

namespace relume {

// Takes the log-average luminance [Reinhard, Stark, Shirley, Ferwerda 2002, equation 1] of cells of pixels.
float automaticExposure(std::span<const glm::vec4> cells) {
    constexpr double kMiddleGrey = 0.18;  // reflectance of a grey card
    constexpr double kDarkest = 1.0 / 64; // of the mean: black corners shall not brighten the rest
    double sum = 0, count = 0;
    for (const glm::vec4& cell : cells) {
        sum += cell.y;
        count += cell.z;
    }
    if (!(count > 0) || !(sum > 0)) return 0.0f;
    const double darkest = std::log2(kDarkest * sum / count);
    double logs = 0;
    for (const glm::vec4& cell : cells)
        if (cell.z > 0.0f) logs += cell.z * std::max(static_cast<double>(cell.x) / cell.z, darkest);
    return static_cast<float>(std::log2(kMiddleGrey) - logs / count);
}

} // namespace relume
