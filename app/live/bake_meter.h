#pragma once

#include "app/live/bake_forecast.h"
#include "assets/base/clock.h"

namespace relume {

/// Adds a point to a convergence curve where the error is told and has changed. Beyond `most` points every
/// other one is dropped.
void addPoint(std::vector<ConvergencePoint>& history, const ConvergencePoint& point, size_t most);

/// Fills in what a status tells of the progress of a bake. Only the bake thread uses it.
class BakeMeter {
public:
    /// Forgets the bake before.
    void begin(BakeStatus& status);
    /// Brings up to date how far the solver is. Now and then it asks the device, too, about rays and memory,
    /// which is slow.
    void update(BakeStatus& status, Baker& baker, const BakeSettings& settings, const vk::Device& device);

private:
    void measure(BakeStatus& status, Solver& solver, const vk::Device& device);

    RayMeter rays_;
    Clock::time_point measured_{};
};

} // namespace relume
