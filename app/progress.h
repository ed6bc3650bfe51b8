#pragma once

#include <chrono>
#include <string>

namespace relume {

/// One line on stderr that tells how a long job stands: rewritten in place on a terminal, a new line every
/// few seconds otherwise.
class ProgressLine {
public:
    ProgressLine();
    ~ProgressLine(); // leaves the terminal's line empty
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// Whether a new text would be shown now; cheap.
    bool due() const;
    void show(const std::string& text);

private:
    bool terminal_;
    std::chrono::steady_clock::time_point next_;
};

/// "12 s", "3 min 05 s", "2 h 10 min"; "?" for a negative number.
std::string formatDuration(double seconds);

} // namespace relume
