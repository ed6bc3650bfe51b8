#pragma once

#include <cstdint>
#include <span>

namespace relume {

struct EmbeddedShader {
    const char* name;
    std::span<const uint32_t> code; // SPIR-V
};

/// Returns the programs of programs.txt, compiled when Relume was built.
std::span<const EmbeddedShader> embeddedShaders();

struct EmbeddedText {
    const char* path; // in shaders/
    const char* text; // GLSL
};

/// Returns the sources that OpenGL compiles at run time, and what they include.
std::span<const EmbeddedText> embeddedTexts();

} // namespace relume
