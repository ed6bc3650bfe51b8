#pragma once

#include <string>
#include <vector>

#include "assets/base/clock.h"

namespace relume {

/// How long one part of a job took.
struct PhaseTime {
    std::string name;
    double seconds = 0;    // by the clock
    double cpuSeconds = 0; // of all threads of the process, the drivers' too
};

/// Returns the CPU time of all threads of this process so far, the drivers' too [s].
double cpuSeconds();
/// Returns the time since this process was started [s], to some hundredths; 0 where the system does not tell.
double processSeconds();

/// Notes the parts of a job as they end, each from the end of the one before.
class PhaseClock {
public:
    explicit PhaseClock(std::vector<PhaseTime>& phases) : phases_(phases) { restart(); }
    /// Ends a part, to which others of this name are added.
    void end(const char* name);
    /// Leaves out what has passed since the last part.
    void restart();

private:
    std::vector<PhaseTime>& phases_;
    Clock::time_point start_;
    double cpu_ = 0;
};

/// Returns the seconds of the part of this name, 0 where there is none.
double secondsOf(const std::vector<PhaseTime>& phases, const std::string& name);

/// Adds the part "other": what a whole of so many seconds took beside these parts, so that they sum up to it.
void addOther(std::vector<PhaseTime>& phases, double seconds, double cpuSeconds);

} // namespace relume
