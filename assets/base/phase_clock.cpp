#include "assets/base/phase_clock.h"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iterator>
#include <sstream>

#include <unistd.h>

namespace relume {

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double processSeconds() {
    // Behind the program's name, which may have blanks and brackets, the start is the 20th field [proc(5)].
    std::ifstream file("/proc/self/stat");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const size_t name = text.rfind(')');
    if (name == std::string::npos) return 0;
    std::istringstream fields(text.substr(name + 1));
    std::string skipped;
    for (int field = 0; field < 19; ++field)
        fields >> skipped;
    double ticks = 0; // since the system was started
    timespec now{};
    if (!(fields >> ticks) || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return 0;
    const double started = ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
    return std::max(0.0, static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - started);
}

void PhaseClock::restart() {
    start_ = Clock::now();
    cpu_ = cpuSeconds();
}

void PhaseClock::end(const char* name) {
    const double seconds = secondsSince(start_), cpu = cpuSeconds() - cpu_;
    const auto known = std::find_if(phases_.begin(), phases_.end(),
                                    [&](const PhaseTime& phase) { return phase.name == name; });
    if (known == phases_.end()) {
        phases_.push_back({name, seconds, cpu});
    } else {
        known->seconds += seconds;
        known->cpuSeconds += cpu;
    }
    restart();
}

double secondsOf(const std::vector<PhaseTime>& phases, const std::string& name) {
    const auto found = std::find_if(phases.begin(), phases.end(),
                                    [&](const PhaseTime& phase) { return phase.name == name; });
    return found == phases.end() ? 0.0 : found->seconds;
}

void addOther(std::vector<PhaseTime>& phases, double seconds, double cpuSeconds) {
    for (const PhaseTime& phase : phases) {
        seconds -= phase.seconds;
        cpuSeconds -= phase.cpuSeconds;
    }
    // The start of a process is known to some hundredths of a second only.
    phases.push_back({"other", std::max(0.0, seconds), std::max(0.0, cpuSeconds)});
}

} // namespace relume
