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
    /// Tells whether the scene is a single GLB that has all the bytes that its header promises.
    bool isWhole() const;
};

/// What a look at the files has found.
struct FileLook {
    std::vector<FileTime> times; // FileSet::timesNow()
    bool whole = false;          // FileSet::isWhole()
    bool finished = false;       // the system says that a writer is done, since the look before (FileNews)
};

/// Says whether files are others than those that are known: no; yes, but their writer may go on; yes.
enum class FileChange { None, Hasty, Settled };

/// Tells when a file that was read, or saved by us, or one beside it, has become another one. It looks at no
/// file itself.
class FileWatch {
public:
    static constexpr double kPeriod = 0.1; // [s] between two looks at the files
    /// A file must have stayed the same for so long [s], as its writer may not be done. One that is whole by
    /// its own words need only be the same at the next look, or at the first where its writer is done.
    static constexpr double kQuiet = 0.5;

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
    /// Takes what a look at the files has found. A change counts once all files have stayed as they are for
    /// long enough, and the scene's own is there.
    FileChange look(const FileLook& found, Clock::time_point now);

private:
    bool on_ = false;
    Clock::time_point looked_{}, changed_{}; // the last look, and the first one that found seen_
    FileSet known_;
    std::vector<FileTime> seen_;
};

} // namespace relume
