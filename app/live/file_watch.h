#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "assets/base/clock.h"

namespace relume {

/// When a file was written last; nothing where there is none.
using FileTime = std::optional<std::filesystem::file_time_type>;
FileTime fileTime(const std::string& path);

/// Tells when a file that was read, or saved by us, has become another one. It looks at no file itself.
class FileWatch {
public:
    /// A file is looked at so often [s], and must have stayed the same for so long: its writer may not be
    /// done.
    static constexpr double kPeriod = 0.5;

    bool on() const { return on_; }
    void setOn(bool on) { on_ = on; }
    /// Takes the time that the file had when it was read or saved.
    void know(FileTime time) { known_ = time; }
    /// Tells whether the file is as it was read or saved.
    bool isKnown(FileTime time) const { return time && time == known_; }
    /// Tells whether it is on and nobody has looked for a period.
    bool isDue(Clock::time_point now) const;
    /// Takes what a look at the file has found. Returns whether it is another file than the one that is
    /// known, and has stayed as it is since the look before.
    bool look(FileTime time, Clock::time_point now);

private:
    bool on_ = false;
    Clock::time_point looked_{};
    FileTime known_, seen_;
};

} // namespace relume
