#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>

// Three floats from 0 on share one exponent in 32 bits [OpenGL 4.6 specification, section 8.5.2]: 9 bits of
// R, G and B from the lowest bit on, then 5 bits of exponent.
namespace relume {

constexpr int kSharedMantissaBits = 9, kSharedBias = 15, kMostSharedBits = 31;
constexpr float kMostSharedExponent = 65408.0f; // 511 / 512 x 2^16

/// Packs a colour from 0 to kMostSharedExponent, rounding to the nearest.
inline uint32_t packSharedExponent(const glm::vec3& color) {
    const float brightest = std::max({color.r, color.g, color.b});
    int exponent = -kSharedBias - 1;
    if (brightest > 0.0f) exponent = std::max(exponent, std::ilogb(brightest));
    int bits = exponent + 1 + kSharedBias;
    // Rounded up, the brightest may need one bit more.
    if (std::lround(std::ldexp(brightest, kSharedMantissaBits + kSharedBias - bits)) >> kSharedMantissaBits)
        ++bits;
    bits = std::clamp(bits, 0, kMostSharedBits);
    uint32_t packed = static_cast<uint32_t>(bits) << (3 * kSharedMantissaBits);
    for (int c = 0; c < 3; ++c) {
        const long mantissa = std::lround(std::ldexp(color[c], kSharedMantissaBits + kSharedBias - bits));
        packed |= static_cast<uint32_t>(mantissa) << (c * kSharedMantissaBits);
    }
    return packed;
}

inline glm::vec3 unpackSharedExponent(uint32_t packed) {
    const int bits = static_cast<int>(packed >> (3 * kSharedMantissaBits));
    const uint32_t mask = (1u << kSharedMantissaBits) - 1;
    glm::vec3 color;
    for (int c = 0; c < 3; ++c)
        color[c] = std::ldexp(static_cast<float>(packed >> (c * kSharedMantissaBits) & mask),
                              bits - kSharedBias - kSharedMantissaBits);
    return color;
}

} // namespace relume
