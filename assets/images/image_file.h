#pragma once

#include <cstdint>
#include <string>

#include "assets/images/float_image.h"

namespace relume {

/// Reads an OpenEXR (all channels as float, the data window, string attributes; R, G, B, A first, then by
/// name), PNG (R, G, B decoded from sRGB to linear), Radiance picture (.hdr; R, G, B) or KTX2 texture (R, G,
/// B; see ktx2.h). Throws Error, also where the picture has more than `mostPixels`.
FloatImage readImage(const std::string& path, uint64_t mostPixels = kMostImagePixels);

/// Writes OpenEXR, or for a path ending in .png 8-bit sRGB of R, G, B clamped to [0,1]. The file gets a
/// temporary name in the same folder first and is renamed, so an existing one is replaced whole or not at
/// all. Equal images give equal bytes. ExrType::Half cuts values beyond its range (65504) with a warning.
/// Throws Error.
void writeImage(const std::string& path, const FloatImage& image, ExrType type = ExrType::Float,
                ExrCompression compression = kExrCompression);

/// Returns the bytes that writeImage writes. Throws Error.
std::string encodeImage(const std::string& path, const FloatImage& image, ExrType type = ExrType::Float,
                        ExrCompression compression = kExrCompression);

/// Returns R, G and B of each pixel as writeImage writes them to a .png: 8 bits, sRGB encoded. Throws Error,
/// naming the image `name`, without these channels.
std::string encodeSrgb(const FloatImage& image, const std::string& name);

/// Returns the bytes that writeImage writes for a .png. Throws Error, naming the image `name`, without R, G
/// and B.
std::string encodePng(const FloatImage& image, const std::string& name);

/// Throws Error where writing `path` is sure to fail (folder missing or unwritable, unknown ending, too
/// little space for `bytes`): call before long work.
void checkWritable(const std::string& path, uint64_t bytes = 0);

} // namespace relume
