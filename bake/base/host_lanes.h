#pragma once

#include <cstdint>
#include <cstring>

#include <glm/glm.hpp>

namespace relume {

/// Numbers side by side, for loops on the CPU; compilers turn them into as many vector registers as it takes.
/// Functions take them by reference: passed by value they would depend on the instruction set.
constexpr uint32_t kLanes = 8;
using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));
using Float4 = float __attribute__((vector_size(4 * sizeof(float))));
using Ints = int32_t __attribute__((vector_size(kLanes * sizeof(int32_t))));

[[gnu::always_inline]] inline void load(Floats& v, const float* lanes) {
    std::memcpy(&v, lanes, sizeof v);
}
[[gnu::always_inline]] inline void load(Float4& v, const glm::vec4& from) {
    std::memcpy(&v, &from, sizeof v);
}

} // namespace relume
