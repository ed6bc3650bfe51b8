#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "assets/base/clock.h"

namespace relume {

/// When a file was written last; nothing where there is none.
using FileTime = std::optional<std::filesystem::file_time_type>;
FileTime fileTime(const std::string& path);

/// A scene's file and the files beside it that belong to it, as they were at one moment.
struct FileSet {
    std::vector<std::string> paths; // the scene's own file first
    std::vector<FileTime> times;    // one of each

    /// Looks for the files that a scene has now, which reads all of its file.
    static FileSet of(const std::string& scene);
    /// Returns the times of the same files as they are now.
    std::vector<FileTime> timesNow() const;
};

/// Tells when a file that was read, or saved by us, or one beside it, has become another one. It looks at no
/// file itself.
class FileWatch {
public:
    /// A file is looked at so often [s], and must have stayed the same for so long: its writer may not be
    /// done.
    static constexpr double kPeriod = 0.5;

    bool on() const { return on_; }
    void setOn(bool on) { on_ = on; }
    /// Takes the files as they were when the scene was read.
    void know(FileSet files);
    /// Takes the time of the scene's file as it was saved, and its path, which may be another one.
    void knowSaved(const std::string& path, FileTime time);
    /// Returns the files that are to be looked at; none before the first was read.
    const FileSet& files() const { return known_; }
    /// Tells whether these are the files that were read or saved, as they were.
    bool isKnown(const FileSet& files) const;
    /// Tells whether it is on and nobody has looked for a period.
    bool isDue(Clock::time_point now) const;
    /// Takes what a look at the files has found. Returns whether one of them is another file than the one
    /// that is known, all have stayed as they are since the look before, and the scene's own is there.
    bool look(const std::vector<FileTime>& times, Clock::time_point now);

private:
    bool on_ = false;
    Clock::time_point looked_{};
    FileSet known_;
    std::vector<FileTime> seen_;
};

} // namespace relume
