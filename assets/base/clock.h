#pragma once

#include <chrono>

namespace relume {

using Clock = std::chrono::steady_clock;

/// Returns the time since `start` [s].
inline double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace relume
