#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "bake/base/series.h"
#include "bake/base/shader_types.h"

namespace relume {

/// The sums over all patches that tell how far light is off; R, G and B together.
struct LightSums {
    double light = 0, count = 0; // lighting, and the number of patches
    double variance = 0;
};

/// Returns how far the light is off, relative to its mean (relRMSE): the root of what samples and
/// `iteration`, the share that later bounces still bring, leave together. Light that is nowhere is off by
/// nothing.
inline double relativeError(const LightSums& sums, double iteration) {
    if (!(sums.light > 0)) return 0.0;
    const double mean = sums.light / (3.0 * sums.count);
    const double variance = sums.variance / (3.0 * sums.count);
    return std::sqrt(variance / (mean * mean) + iteration * iteration);
}

/// Follows the changes from bounce to bounce, and tells by them what later bounces still bring.
struct BounceSeries {
    double change = 0; // of the last bounce, root mean square [cd/m^2]; 0: none was seen
    double ratio = 0;  // of the last two changes
    double error = 1;  // what is still to come, relative to the mean light; 1 until it can be told

    /// Learns what the newest bounce changed, from sums over all patches as ChangePush makes them: squared
    /// change, light, number of patches. Returns the mean light.
    double learn(const glm::dvec4& sums) {
        const double now = sums.z > 0 ? std::sqrt(sums.x / (3.0 * sums.z)) : 0.0;
        const double mean = sums.z > 0 ? sums.y / (3.0 * sums.z) : 0.0;
        if (const std::optional<SeriesRest> rest = seriesRest(change, now, mean)) {
            ratio = rest->ratio;
            error = rest->error;
        }
        change = now;
        return mean;
    }
    /// Returns how many bounces there are until `aim` is left, as the ratio has it, 1 at least and `most` at
    /// most.
    uint32_t bouncesTo(double aim, uint32_t most) const {
        const double more = std::log(aim / error) / std::log(ratio);
        return ratio < 1.0 && more > 1.0 ? static_cast<uint32_t>(std::ceil(std::min(more, double(most)))) : 1;
    }
};

} // namespace relume
