#pragma once

#include <set>
#include <string>
#include <vector>

namespace relume {

/// A scene that was opened before, as the start page lists it.
struct RecentFile {
    std::string path, name, folder;
    bool gone = false; // there is no such file any more
    bool operator==(const RecentFile&) const = default;
};

/// Returns those of the paths at which there is no file now. It asks the file system, which may take long: it
/// is for another thread than the main one.
std::set<std::string> goneFiles(const std::vector<std::string>& paths);

/// Returns what the start page lists, in the order of `recent`, the newest first. `gone` is what goneFiles()
/// said last; paths that it was not asked about count as there. A folder below `home` begins with "~".
std::vector<RecentFile> recentFiles(const std::vector<std::string>& recent, const std::set<std::string>& gone,
                                    const std::string& home);

} // namespace relume
