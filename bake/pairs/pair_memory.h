#pragma once

#include "bake/solver/solver.h"
#include "bake/solver/solver_extent.h"

namespace relume {

/// The owner of the pair methods' memory, beside kept bits (BitsCache::kOwner).
inline constexpr const char* kPairsOwner = "pairs";
/// Each analytic light that has an extent gets so many rays per patch and sample pass: few enough for a batch
/// to be short.
inline constexpr uint32_t kPairLampRays = 16;

/// Returns the most device bytes that PairSolver takes at a time, beside LightBuffers and kept bits
/// (BitsCache::bytes).
uint64_t pairSolverBytes(const SolverExtent& extent, const SolverSettings& settings);
/// Returns that part of it that lists of senders take, which the host holds once more; 0 for other methods.
uint64_t pairSenderBytes(const SolverExtent& extent, const SolverSettings& settings);

} // namespace relume
