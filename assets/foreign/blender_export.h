#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace relume {

/// Returns the path of Blender's program, nothing where it is not installed.
std::optional<std::string> findBlender();

/// Lets Blender write a .blend file as a GLB, by the add-on of assets/blender: Blender reads each of its own
/// versions, and knows its lights and materials best. Scripts in the file do not run. The process ends with
/// this one, and has its limits. Returns the GLB's bytes. Throws Error naming the file.
std::vector<uint8_t> exportByBlender(const std::string& blender, const std::string& path);

} // namespace relume
