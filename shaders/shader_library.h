#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relume {

/// Returns the SPIR-V of a shader by name, as listed in shaders/programs.txt ("occlusion_bvh"). It comes from
/// the executable, or, after setShaderFolder, is compiled from that folder's sources. Throws Error (with file
/// and line of the first error).
std::vector<uint32_t> shaderCode(const std::string& name);

/// Returns the names that shaderCode knows.
std::vector<std::string> shaderNames();

/// Returns the text of a source by its path in shaders/ ("gl/scene.frag", "lib/tone.glsl"): those that OpenGL
/// compiles, at run time. It comes from the executable or from setShaderFolder's folder. Throws Error.
std::string shaderText(const std::string& path);

/// Makes later calls compile from sources in `folder` (a copy of shaders/), each time anew. "" goes back to
/// the embedded code. Throws Error when the folder does not hold them.
void setShaderFolder(const std::string& folder);
/// Returns that folder; "" means the embedded code.
std::string shaderFolder();

} // namespace relume
