#pragma once

#include "assets/base/clock.h"

namespace relume {

/// Adds up how long the functions take that it calls.
struct Stopwatch {
    double seconds = 0;

    template<typename F>
    decltype(auto) operator()(F&& work) {
        struct Running {
            double& seconds;
            Clock::time_point start = Clock::now();
            ~Running() { seconds += secondsSince(start); }
        } running{seconds};
        return work();
    }
};

} // namespace relume
