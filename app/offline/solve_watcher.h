#pragma once

#include "bake/solver/solver.h"

namespace relume {

/// Something that is done while a bake goes on, between its steps.
class SolveWatcher {
public:
    virtual ~SolveWatcher() = default;
    /// Is called after every step but the last one.
    virtual void afterStep(Solver& solver) = 0;
    /// Throws the Error that ends a bake which the user interrupted.
    [[noreturn]] virtual void interrupt(Solver& solver) = 0;
};

} // namespace relume
