#include "app/viewer/window/path_completion.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool hasEnding(const std::string& name, const std::vector<std::string>& endings) {
    const std::string plain = lower(name);
    return endings.empty() || std::any_of(endings.begin(), endings.end(),
                                          [&](const std::string& ending) { return plain.ends_with(ending); });
}

} // namespace

std::string expandHome(const std::string& path) {
    const char* home = std::getenv("HOME");
    if (home == nullptr || !path.starts_with("~")) return path;
    if (path.size() > 1 && path[1] != '/') return path; // another user's
    return home + path.substr(1);
}

PathCompletion completePath(const std::string& typed, const std::vector<std::string>& endings) {
    const std::string path = expandHome(typed);
    const size_t slash = path.find_last_of('/');
    const std::string before = slash == std::string::npos ? "" : path.substr(0, slash + 1);
    const std::string begun = path.substr(before.size());
    PathCompletion result{path, {}};
    std::error_code code;
    fs::directory_iterator entry(before.empty() ? "." : before, code);
    for (; !code && entry != fs::directory_iterator(); entry.increment(code)) {
        const std::string name = entry->path().filename().string();
        if (!name.starts_with(begun) || (begun.empty() && name.starts_with('.'))) continue;
        std::error_code ignored;
        if (entry->is_directory(ignored))
            result.matches.push_back(before + name + "/");
        else if (hasEnding(name, endings))
            result.matches.push_back(before + name);
    }
    std::sort(result.matches.begin(), result.matches.end());
    if (result.matches.empty()) return result;
    // The matches are sorted: what the first and the last have in common all have.
    const std::string &first = result.matches.front(), &last = result.matches.back();
    const auto differs = std::mismatch(first.begin(), first.end(), last.begin(), last.end());
    result.text.assign(first.begin(), differs.first);
    return result;
}

std::string freePath(const std::string& path) {
    std::error_code code;
    const auto taken = [&](const fs::path& candidate) {
        const fs::file_type type = fs::symlink_status(candidate, code).type();
        return type != fs::file_type::not_found && type != fs::file_type::none; // none: it cannot be told
    };
    if (!taken(path)) return path;
    const fs::path whole(path);
    for (int number = 2;; ++number) {
        const fs::path candidate =
            whole.parent_path() /
            (whole.stem().string() + "_" + std::to_string(number) + whole.extension().string());
        if (!taken(candidate)) return candidate.string();
    }
}

} // namespace relume
