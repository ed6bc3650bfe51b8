#pragma once

#include <memory>

#include "bake/solver/solver.h"

namespace relume {

/// Makes a solver. Throws Error when the method cannot run (too many pairs, not enough memory).
std::unique_ptr<Solver> makeSolver(const SolverInput& input, const SolverSettings& settings);

/// Returns the device bytes of a solver's own buffers, beside LightBuffers, for patches in so many chunks.
uint64_t solverBytes(uint32_t chunkCount, bool software, const SolverSettings& settings);

} // namespace relume
