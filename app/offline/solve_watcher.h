#pragma once

#include "bake/solver/solver.h"

namespace relume {

/// Something that is done while a bake goes on, between its steps.
class SolveWatcher {
public:
    virtual ~SolveWatcher() = default;
    /// Is called after every step but the last one; where several processes bake, only between two passes,
    /// on all of them, and when the first one's is due().
    virtual void afterStep(Solver& solver) = 0;
    /// Tells whether afterStep() has something to do.
    virtual bool due() const { return true; }
    /// Tells whether interrupt() needs the solver's state.
    virtual bool saves() const { return false; }
    /// Throws the Error that ends a bake which the user interrupted.
    [[noreturn]] virtual void interrupt(Solver& solver) = 0;
};

} // namespace relume
