#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "assets/images/float_image.h"

// Radiance pictures (.hdr) are text lines, then pixels of 8-bit mantissas with one exponent (RGBE).
namespace relume {

struct RadianceHeader {
    uint32_t width = 0, height = 0;
    size_t dataBegin = 0; // where the pixels begin in the file's bytes
};

/// Reads the header. Throws std::runtime_error where the bytes are no RGBE picture stored from the top left.
RadianceHeader readRadianceHeader(std::string_view bytes);

/// Returns the pixels as channels R, G and B. Throws std::runtime_error where they are damaged or end too
/// early.
FloatImage decodeRadiance(std::string_view bytes, const RadianceHeader& header);

} // namespace relume
