#include "app/offline/progress.h"

#include "assets/base/clock.h"
#include "assets/base/log.h"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace relume {
namespace {

constexpr std::chrono::milliseconds kTerminalPeriod{100}, kSparsePeriod{5000};

} // namespace

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) != 0), next_(Clock::now()) {
    if (!terminal_) next_ += kSparsePeriod;
}

ProgressLine::~ProgressLine() {
    if (terminal_ && spdlog::should_log(spdlog::level::info)) std::fputs("\r\033[K", stderr);
}

bool ProgressLine::due() const {
    return spdlog::should_log(spdlog::level::info) && Clock::now() >= next_; // not with --quiet
}

void ProgressLine::show(const std::string& text) {
    next_ = Clock::now() + (terminal_ ? kTerminalPeriod : kSparsePeriod);
    if (terminal_)
        std::fprintf(stderr, "\r%s\033[K", text.c_str());
    else
        std::fprintf(stderr, "%s\n", text.c_str());
    std::fflush(stderr);
}

PhaseProgress::PhaseProgress(bool nothingToLose) : scope_(*this) {
    if (nothingToLose) abandonable_.emplace();
}

PhaseProgress::~PhaseProgress() = default;

void PhaseProgress::hear(const char* phase, double done) {
    stopIfInterrupted();
    if (line_.due()) line_.show(phaseText(phase, done));
}

std::string phaseText(const char* phase, double done) {
    return done >= 0 ? fmt::format("{}  {:.0f} %", phase, 100.0 * done) : phase;
}

std::string formatDuration(double seconds) {
    if (!(seconds >= 0)) return "?";
    const auto s = static_cast<long>(seconds + 0.5);
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
    return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

} // namespace relume
