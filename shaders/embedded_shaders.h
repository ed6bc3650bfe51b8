#pragma once

#include <cstdint>
#include <span>

namespace relume {

struct EmbeddedShader {
    const char* name;
    std::span<const uint32_t> code; // SPIR-V
};

/// The programs of programs.txt, compiled when Relume was built.
std::span<const EmbeddedShader> embeddedShaders();

} // namespace relume
