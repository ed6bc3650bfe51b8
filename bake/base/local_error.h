#pragma once

#include <cstdint>
#include <span>

#include "assets/base/worker_pool.h"
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

/// Returns percentiles of errors that are normally distributed, from counts of texels by the standard
/// deviation of theirs, in the same bins. All is 0 where nothing is off.
LocalError normalErrorOf(std::span<const double> deviationBins);

/// A chunk's sums over its texels of squares, relative to the square of what local error is relative to.
struct ChunkSquares {
    double texels = 0;
    double noise = 0; // >= 0
    double bias = 0;  // of smoothing, as it was estimated: below nothing by chance
    /// Fourth powers of the bias, as they were estimated: how unevenly it lies; nothing: it lies evenly.
    double fourth = 0;
};
/// Returns what noise and the bias of smoothing make together, from the error of the noise alone. Where a
/// chunk's bias stands out of the noise of its estimate, it is taken to be there, in as many texels as its
/// fourth powers tell; what is left of it in the sum of all others, to be where their noise is.
LocalError withBias(WorkerPool& pool, const LocalError& noise, std::span<const ChunkSquares> chunks);

} // namespace relume
