#pragma once

#include <span>

#include "app/live/bake_desk.h"

namespace relume {

/// Seconds until the error falls to `aim`, by the power law through the newest point and one from about half
/// its time: sampling errors fall as a power of the time that was spent. Negative: it does not fall, or there
/// are too few points to tell.
double secondsUntil(std::span<const ConvergencePoint> history, double aim);

/// Rays per second over the last while.
class RayMeter {
public:
    /// seconds: of any clock; rays: so far.
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
