#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace relume {

struct ShaderSource {
    std::string name;                     // path or name for messages; its ending (".comp") gives the stage
    std::string text;                     // GLSL
    std::vector<std::string> definitions; // "NAME" or "NAME=VALUE"
    std::string includeFolder;            // where #include "shared.h" and "lib/pairs.glsl" are found
};

/// Compiles GLSL text to SPIR-V 1.5, for Vulkan 1.2. Throws Error: "gather.comp:12: 'x' : undeclared
/// identifier".
std::vector<uint32_t> compileShader(const ShaderSource& source);

} // namespace relume
