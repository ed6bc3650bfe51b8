#pragma once

#include <memory>

#include "bake/solver/solver.h"
#include "bake/solver/solver_extent.h"

namespace relume {

class LayerSolver;
struct LayerCarry;

/// A solver, and what more is known of it.
struct MadeSolver {
    std::unique_ptr<Solver> solver;
    LayerSolver* layers = nullptr; // the same one, where each light has a layer
};

/// Makes a solver; one of layers goes on with what `carry` says, if anything. Throws Error when the method
/// cannot run (too many pairs, not enough memory).
MadeSolver makeSolver(const SolverInput& input, const SolverSettings& settings,
                      const LayerCarry* carry = nullptr);

/// Returns the most device bytes that a solver's own buffers take at a time, beside LightBuffers, layers and
/// what is kept in caches, but for the links of one sample pass of LinkSolver.
uint64_t solverBytes(const SolverExtent& extent, const SolverSettings& settings);

} // namespace relume
