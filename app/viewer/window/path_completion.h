#pragma once

#include <string>
#include <vector>

namespace relume {

/// What a typed path may become.
struct PathCompletion {
    std::string text;                 // the typed path, as far as it can only go on one way
    std::vector<std::string> matches; // whole paths, folders with a slash behind them, by name
};

/// Looks at the folder that `typed` names; of its files those whose name ends in one of `endings` (none: all)
/// count, case aside. "~/" is the home folder. Hidden ones only when they are asked for.
PathCompletion completePath(const std::string& typed, const std::vector<std::string>& endings);

/// "~/x" with the home folder instead of the "~".
std::string expandHome(const std::string& path);

/// A path of the same folder and ending that does not exist: the path itself, else with _2, _3, ... before
/// its ending.
std::string freePath(const std::string& path);

} // namespace relume
