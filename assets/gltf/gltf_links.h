#pragma once

#include <string>
#include <vector>

namespace relume {

/// The files beside a .gltf or .glb file that belong to it: buffers, images and the sky's picture, as paths.
/// None where it cannot be read, which whoever loads it will tell.
std::vector<std::string> linkedFiles(const std::string& path);

} // namespace relume
