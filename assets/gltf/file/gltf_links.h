#pragma once

#include <string>
#include <vector>

namespace relume {

/// Returns the files beside a .gltf or .glb file that belong to it, as paths: buffers, images and the sky's
/// picture. There are none where it cannot be read, which whoever loads it will tell.
std::vector<std::string> linkedFiles(const std::string& path);

} // namespace relume
