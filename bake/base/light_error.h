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
    double change = 0;      // of the last bounce, root mean square [cd/m^2]; 0: none was seen
    double ratio = 0;       // of the last two changes
    double error = 1;       // what is still to come, relative to the mean light; 1 until it can be told
    double localChange = 0; // of the last bounce, relative to each patch's own light, on the mean; 0: none
    double localRatio = 0;  // of the last two of these
    double localError = 1;  // what is still to come of that; 1 until it can be told

    /// Learns what the newest bounce changed, from sums over all patches as ChangePush makes them: squared
    /// change, light, number of patches and, unless it is the first bounce, relative change. Returns the mean
    /// light.
    double learn(const glm::dvec4& sums, bool isFirst = false) {
        const double now = sums.z > 0 ? std::sqrt(sums.x / (3.0 * sums.z)) : 0.0;
        const double mean = sums.z > 0 ? sums.y / (3.0 * sums.z) : 0.0;
        if (const std::optional<SeriesRest> rest = seriesRest(change, now, mean)) {
            ratio = rest->ratio;
            error = rest->error;
        }
        change = now;
        if (!isFirst) learnLocally(sums.z > 0 ? sums.w / sums.z : 0.0);
        return mean;
    }
    /// Forgets what the last bounce changed: the next one is of another stage.
    void forgetChange() { change = localChange = 0; }

    /// Tells whether no more is left than these.
    bool isWithin(double aim, double localAim) const { return error <= aim && localError <= localAim; }
    /// Returns how many bounces there are until no more is left, as the ratios have it, 1 at least and `most`
    /// at most.
    uint32_t bouncesTo(double aim, double localAim, uint32_t most) const {
        const double more =
            std::max(bounces(error, ratio, aim, most), bounces(localError, localRatio, localAim, most));
        return static_cast<uint32_t>(std::ceil(std::clamp(more, 1.0, double(most))));
    }

private:
    // Light of a closed room falls by its albedo from bounce to bounce, more slowly than all of the change
    // does at first, of which it is little.
    void learnLocally(double now) {
        constexpr double kLeastRatio = 0.75;
        if (localChange > 0 || now == 0) {
            localRatio = now > 0 ? std::max(kLeastRatio, now / localChange) : 0.0;
            localError = localRatio < 1.0 ? std::min(1.0, now * localRatio / (1.0 - localRatio)) : 1.0;
        }
        localChange = now;
    }
    static double bounces(double left, double ratio, double aim, uint32_t most) {
        if (left <= aim || ratio >= 1.0) return 0.0;
        return ratio > 0.0 ? std::min(std::log(aim / left) / std::log(ratio), double(most)) : 1.0;
    }
};

} // namespace relume
