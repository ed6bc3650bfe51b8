#pragma once

#include <span>

#include "app/live/bake_desk.h"

namespace relume {

/// Returns the seconds until the error falls to `aim`, by the power law through the newest point and one from
/// about half its time: sampling errors fall as a power of the time that was spent. The result is negative
/// when the error does not fall, or when there are too few points to tell.
double secondsUntil(std::span<const ConvergencePoint> history, double aim,
                    double ConvergencePoint::*error = &ConvergencePoint::error);

/// Measures rays per second over the last window of time.
class RayMeter {
public:
    /// Adds a measurement: the seconds of any clock, and the rays that were traced so far.
    void add(double seconds, uint64_t rays);
    void clear() { count_ = 0; }
    double perSecond() const; // 0: not known yet

private:
    static constexpr double kWindow = 1.0; // [s]: long enough to be read, short enough to follow
    struct Mark {
        double seconds = 0;
        uint64_t rays = 0;
    };
    Mark oldest_, middle_, newest_; // a new window begins at the middle of the one before
    uint32_t count_ = 0;
};

} // namespace relume
