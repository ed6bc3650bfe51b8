#pragma once

#include <optional>

namespace relume {

/// Holds what is left of a geometric series of bounces after one of its terms.
struct SeriesRest {
    double ratio = 0; // of the last two changes
    double error = 0; // what is still to come, relative to the mean light; 1 where the series does not fall
};

/// Tells what later bounces still bring, if the changes that bounces make go on as they did: the rest of a
/// geometric series of ratio q after a term c is c q / (1 - q). `before` and `change` are what the last two
/// bounces changed, root mean square; before 0: there was none yet. Nothing where it cannot be told yet. A
/// light that does not change, or that reaches nothing, has no rest.
inline std::optional<SeriesRest> seriesRest(double before, double change, double mean) {
    if (change == 0.0 || mean <= 0.0) return SeriesRest{};
    if (before <= 0.0) return std::nullopt;
    const double ratio = change / before;
    return SeriesRest{ratio, ratio < 1.0 ? change * ratio / (1.0 - ratio) / mean : 1.0};
}

} // namespace relume
