#pragma once

#include <string>
#include <vector>

namespace relume {

/// Tells whether a file is to be converted before it can be read: by its ending, or where that is none that
/// is known, by its first bytes. A file that begins as a GLB does is none, whatever its name.
bool isForeign(const std::string& path);

/// Returns the endings of the files that are converted, in lower case: ".obj", ".fbx", ...
const std::vector<std::string>& foreignEndings();

/// Returns a file's ending in lower case, ".obj", or "" where it has none.
std::string lowerEnding(const std::string& path);

/// Returns what helps where libassimp cannot read a file: Blender reads all .blend files.
std::string mendOf(const std::string& path);

} // namespace relume
