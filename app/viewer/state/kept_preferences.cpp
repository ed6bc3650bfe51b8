#include "app/viewer/state/kept_preferences.h"

#include "assets/base/error.h"
#include "assets/base/log.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

/// Keeps other viewers from a folder's preferences while it lives. The folder itself is what is locked, so
/// that no file is left behind. Where it cannot be locked, as on some network file systems, or another
/// process does not let go of it, the viewer goes on without: its file is still written whole.
class FolderLock {
public:
    explicit FolderLock(const std::string& folder)
        : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
        // The lock is held while a few kilobytes are read and written. One that is held for much longer is
        // that of a process that has stopped, and the window is not to stop with it.
        constexpr int kTries = 200;
        constexpr std::chrono::milliseconds kPause(10);
        for (int i = 0; i < kTries && descriptor_ >= 0; ++i) {
            if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || (errno != EWOULDBLOCK && errno != EINTR))
                return;
            std::this_thread::sleep_for(kPause);
        }
    }
    ~FolderLock() {
        if (descriptor_ >= 0) close(descriptor_); // which lets go of the lock
    }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int descriptor_;
};

bool contains(const std::vector<std::string>& list, const std::string& path) {
    return std::find(list.begin(), list.end(), path) != list.end();
}

std::vector<std::string> mergeRecent(std::vector<std::string> before, const std::vector<std::string>& own,
                                     std::vector<std::string> theirs) {
    std::vector<std::string> forgotten;
    for (const std::string& path : before)
        if (!contains(own, path)) forgotten.push_back(path);
    // A full list drops its last scenes by itself; those were not forgotten.
    if (own.size() == Preferences::kMostRecent) forgotten.clear();
    std::erase_if(theirs, [&](const std::string& path) { return contains(forgotten, path); });
    std::erase_if(before, [&](const std::string& path) { return contains(forgotten, path); });
    Preferences merged;
    merged.recent = std::move(theirs);
    for (size_t i = own.size(); i-- > 0;) {
        const bool first = i == 0 && (before.empty() || before.front() != own.front());
        if (first || !contains(before, own[i])) merged.pushRecent(own[i]);
    }
    return merged.recent;
}

using Marks = std::vector<Bookmark>;

const Bookmark* findMark(const Marks& marks, const std::string& name) {
    const auto found =
        std::find_if(marks.begin(), marks.end(), [&](const Bookmark& mark) { return mark.name == name; });
    return found != marks.end() ? &*found : nullptr;
}

const Marks& marksOf(const Preferences& preferences, const std::string& scene) {
    static const Marks kNone;
    const auto found = preferences.bookmarks.find(scene);
    return found != preferences.bookmarks.end() ? found->second : kNone;
}

} // namespace

Preferences mergePreferences(const Preferences& before, const Preferences& own, const Preferences& theirs) {
    Preferences merged = own;
    merged.recent = mergeRecent(before.recent, own.recent, theirs.recent);
    merged.bookmarks = theirs.bookmarks;
    for (const auto& [scene, marks] : before.bookmarks)
        for (const Bookmark& mark : marks)
            if (findMark(marksOf(own, scene), mark.name) == nullptr)
                std::erase_if(merged.bookmarks[scene],
                              [&](const Bookmark& other) { return other.name == mark.name; });
    for (const auto& [scene, marks] : own.bookmarks)
        for (const Bookmark& mark : marks) {
            if (findMark(marksOf(before, scene), mark.name) != nullptr) continue; // it is not new
            const Bookmark* other = findMark(merged.bookmarks[scene], mark.name);
            if (other == nullptr)
                merged.bookmarks[scene].push_back(mark);
            else if (other->camera != mark.camera)
                merged.addBookmark(scene, mark.camera);
        }
    std::erase_if(merged.bookmarks, [](const auto& entry) { return entry.second.empty(); });
    return merged;
}

KeptPreferences::KeptPreferences(std::string path) : path_(std::move(path)) {
    if (!path_.empty()) own_ = readPreferences(path_);
    before_ = own_;
}

void KeptPreferences::save() {
    if (path_.empty()) return;
    try {
        const std::string folder = fs::path(path_).parent_path().string();
        std::error_code code; // a folder that cannot be made is told by what is written there
        fs::create_directories(folder, code);
        const FolderLock lock(folder);
        Preferences merged = mergePreferences(before_, own_, findPreferences(path_).value_or(before_));
        writePreferences(path_, merged);
        before_ = own_ = std::move(merged); // what could not be written is new the next time, too
    } catch (const Error& error) {
        spdlog::warn("{}", error.what());
    }
}

} // namespace relume
