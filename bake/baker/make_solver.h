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

/// Tells how much of what a solver takes may be in the host's memory, from where the device reads it in the
/// order of patches. Pair methods read all of it for each chunk, and footprints read light anywhere.
Spill mostSpill(const SolverSettings& settings);

/// Returns the extent of these patches; their lights are not counted.
SolverExtent extentOf(const PatchSet& patches, const Sky& sky, bool software);

/// Holds what is free where a solver is made [bytes].
struct SolverRoom {
    uint64_t device = 0;
    uint64_t host = 0;   // 0: unknown
    SpilledBytes own;    // that the solver takes of it without caches and layers
    bool shared = false; // both are the same
};
/// Says how much memory caches and layers may take where the settings do not: their share, but no more than
/// the solver's own buffers leave. Links and layers that the device has no room for are in the host's memory.
void shareMemory(const SolverRoom& room, SolverSettings& settings);

/// Makes a solver; one of layers goes on with what `carry` says, if anything. Throws Error when the method
/// cannot run (too many pairs, not enough memory).
MadeSolver makeSolver(const SolverInput& input, const SolverSettings& settings,
                      const LayerCarry* carry = nullptr);

/// Returns the most bytes that a solver's own buffers take at a time, beside LightBuffers, layers and what is
/// kept in caches, but for the links of one sample pass of LinkSolver.
SpilledBytes solverBytes(const SolverExtent& extent, const SolverSettings& settings);

} // namespace relume
