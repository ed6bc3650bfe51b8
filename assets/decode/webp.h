#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace relume {

struct WebpSize {
    uint32_t width = 0, height = 0; // [pixels], each from 1 to 16383, which the format cannot exceed
};

/// Tells whether the bytes begin as a WebP picture does.
bool isWebp(std::span<const uint8_t> bytes);

/// Returns the size that a WebP picture's header tells, or nothing where it is none or an animation. Takes no
/// memory for pixels. A picture of one colour needs some 30 bytes whatever its size, so that the caller has
/// to bound the size by itself.
std::optional<WebpSize> webpSize(std::span<const uint8_t> bytes);

/// Decodes to 8-bit RGBA, row 0 first [width * height * 4]. Returns nothing where the bytes are damaged, end
/// early or are an animation.
std::optional<std::vector<uint8_t>> decodeWebp(std::span<const uint8_t> bytes);

} // namespace relume
