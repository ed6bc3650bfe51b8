#include "app/viewer/state/recent_files.h"

#include <filesystem>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

std::string shownFolder(const std::string& folder, const std::string& home) {
    if (home.empty() || home == "/" || !folder.starts_with(home)) return folder;
    const std::string rest = folder.substr(home.size());
    return rest.empty() || rest.front() == '/' ? "~" + rest : folder;
}

} // namespace

std::set<std::string> goneFiles(const std::vector<std::string>& paths) {
    std::set<std::string> gone;
    std::error_code
        code; // a file that cannot be asked about, as its folder is locked, cannot be opened either
    for (const std::string& path : paths)
        if (!fs::is_regular_file(path, code)) gone.insert(path);
    return gone;
}

std::vector<RecentFile> recentFiles(const std::vector<std::string>& recent, const std::set<std::string>& gone,
                                    const std::string& home) {
    std::vector<RecentFile> files;
    for (const std::string& path : recent) {
        const fs::path parts(path);
        files.push_back({.path = path,
                         .name = parts.filename().string(),
                         .folder = shownFolder(parts.parent_path().string(), home),
                         .gone = gone.contains(path)});
    }
    return files;
}

} // namespace relume
