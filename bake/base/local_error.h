#pragma once

#include <cstdint>
#include <span>

#include "bake/base/shader_types.h"

namespace relume {

/// Texels darker than this share of the median light are off relative to that share of it.
constexpr double kLocalFloor = 0.05;

/// The local error of a texel is |light - true light| / max(true light, kLocalFloor times the median light),
/// the light being the mean of R, G and B, the median that of all covered texels.
struct LocalError {
    double p50 = 1, p90 = 1, p95 = 1, p99 = 1; // percentiles over all covered texels
};

/// Returns the median light, and percentiles of errors, from counts in the bins of lib/local_error.glsl. A
/// percentile is told within a bin by its place there; nothing in the bins is 0.
double medianLight(std::span<const uint32_t> lightBins);
LocalError localErrorOf(std::span<const uint32_t> errorBins);

/// Returns what noise and the bias of smoothing make together, from the error of the noise alone and both
/// sums of squares over all texels. Which texels the bias is in is too uncertain to be told: it is taken to
/// be where the noise is. What is left of it below nothing, by chance, is none.
LocalError withBias(const LocalError& error, double noise, double bias);

} // namespace relume
