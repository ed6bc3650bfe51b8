#pragma once

#include <string>
#include <vector>

namespace relume {

/// Returns the files near a model that it names, and those that its material libraries name: such libraries
/// and pictures, each once. Every name in the file's bytes that ends as they do and leads to a file near by
/// (see NearFiles) counts, also one that is of no use to the scene. There are none where the file cannot be
/// read, and none in files that are compressed.
std::vector<std::string> namedFiles(const std::string& path);

} // namespace relume
