#include "app/live/watch/file_watch.h"

#include "assets/foreign/foreign_files.h"
#include "assets/foreign/load_scene.h"
#include "assets/gltf/file/gltf_file.h"

#include <chrono>
#include <system_error>
#include <utility>

namespace relume {

FileTime fileTime(const std::string& path) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(path, error);
    return error ? FileTime() : FileTime(time);
}

FileSet FileSet::of(const std::string& scene) {
    FileSet files;
    files.paths = filesOfScene(scene);
    files.paths.insert(files.paths.begin(), scene);
    files.times = files.timesNow();
    return files;
}

std::vector<FileTime> FileSet::timesNow() const {
    std::vector<FileTime> now;
    for (const std::string& path : paths)
        now.push_back(fileTime(path));
    return now;
}

bool FileSet::isWhole() const {
    return paths.size() == 1 && gltf::isWholeGlb(paths.front());
}

bool FileWatch::isDue(Clock::time_point now) const {
    return on_ && std::chrono::duration<double>(now - looked_).count() >= kPeriod;
}

FileChange FileWatch::look(const FileLook& found, Clock::time_point now) {
    const std::vector<FileTime>& times = found.times;
    looked_ = now;
    const bool same = times == seen_;
    if (!same) {
        seen_ = times;
        changed_ = now;
    }
    if (times.empty() || !times.front() || times == known_.times) return FileChange::None;
    if (same && std::chrono::duration<double>(now - changed_).count() >= kQuiet) return FileChange::Settled;
    return found.whole && (same || found.finished) ? FileChange::Hasty : FileChange::None;
}

void FileWatch::know(FileSet files) {
    known_ = std::move(files);
}

void FileWatch::knowSaved(const std::string& path, FileTime time) {
    // A file that was converted is saved as one that has its pictures within.
    if (known_.paths.empty() || isForeign(known_.paths.front()) || known_.times.empty())
        known_ = {{path}, {time}};
    known_.paths.front() = path;
    known_.times.front() = time;
}

bool FileWatch::isKnown(const FileSet& files) const {
    return !files.times.empty() && files.times.front() && files.paths == known_.paths &&
           files.times == known_.times;
}

} // namespace relume
