#pragma once

#include "app/offline/solve_watcher.h"
#include "app/text/interrupt.h"
#include "bake/baker/baker.h"

namespace relume {

/// Warns about a scene in which nothing emits.
void warnIfDark(const Scene& scene, const PatchSet& patches);

/// Steps the solver to its end and shows how it stands; warns when the error asked for was not reached.
/// Throws Error when the user interrupts. All of these ranks call it, and watch together.
void solve(Solver& solver, const SolverSettings& settings, SolveWatcher& watcher,
           Ranks& ranks = oneProcess());

/// Throws Error where the validation layers had something to say.
void failOnValidation(uint32_t messages);

} // namespace relume
