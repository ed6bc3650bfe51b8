#pragma once

#include <string>
#include <vector>

namespace relume {

/// The paths that a typed path may become.
struct PathCompletion {
    std::string text;                 // the typed path, as far as it can only go on one way
    std::vector<std::string> matches; // whole paths, folders with a slash behind them, by name
};

/// Looks at the folder that `typed` names. Those of its files count whose name ends in one of `endings`
/// (none: all), in whatever case, and hidden ones only when they are asked for. "~/" is the home folder.
PathCompletion completePath(const std::string& typed, const std::vector<std::string>& endings);

/// Returns "~/x" with the home folder instead of the "~".
std::string expandHome(const std::string& path);

/// Returns a path of the same folder and ending that does not exist: the path itself, else with _2, _3, ...
/// before its ending.
std::string freePath(const std::string& path);

} // namespace relume
