#pragma once

#include <cstdint>
#include <string>

namespace relume {

/// Returns 8-bit pixels, `channels` bytes each (1: grey, 3: RGB, 4: RGBA), row 0 on top and rows without
/// gaps, as a PNG file [W3C, Portable Network Graphics Specification]. All cores filter and deflate it; equal
/// pixels give equal bytes, however many cores there are. Throws Error, naming the image `name`, where it
/// cannot be packed.
std::string writePng(const std::string& pixels, uint32_t width, uint32_t height, uint32_t channels,
                     const std::string& name);

} // namespace relume
