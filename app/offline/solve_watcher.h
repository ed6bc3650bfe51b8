#pragma once

#include "bake/solver/solver.h"

namespace relume {

/// What is done on the way of a bake, between its steps.
class SolveWatcher {
public:
    virtual ~SolveWatcher() = default;
    /// After every step but the last one.
    virtual void afterStep(Solver& solver) = 0;
    /// Throws the Error that ends a bake which the user interrupted.
    [[noreturn]] virtual void interrupt(Solver& solver) = 0;
};

} // namespace relume
