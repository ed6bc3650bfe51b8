#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "app/text/interrupt.h"
#include "assets/base/watch.h"

namespace relume {

/// One line on stderr that tells how a long job stands. On a terminal it is rewritten in place, otherwise
/// there is a new line every few seconds.
class ProgressLine {
public:
    ProgressLine();
    ~ProgressLine(); // leaves the terminal's line empty
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// Tells whether a new text would be shown now. The call is cheap.
    bool due() const;
    void show(const std::string& text);

private:
    bool terminal_;
    std::chrono::steady_clock::time_point next_;
};

/// Shows how the work before and after a bake's steps stands, phase by phase, and ends it on Ctrl-C.
class PhaseProgress final : public Watch {
public:
    /// Begins; with nothingToLose the work is Abandonable.
    explicit PhaseProgress(bool nothingToLose);
    ~PhaseProgress() override;
    /// Throws Error when Ctrl-C was pressed while an InterruptGuard exists.
    void hear(const char* phase, double done) override;

private:
    ProgressLine line_;
    std::optional<Abandonable> abandonable_;
    WatchScope scope_;
};

/// Returns "patches 45 %", or "tracer" where the share is not known.
std::string phaseText(const char* phase, double done);

/// Returns "12 s", "3 min 05 s" or "2 h 10 min"; "?" for a negative number.
std::string formatDuration(double seconds);

} // namespace relume
