#pragma once

#include <cstdint>
#include <string>

#include "assets/images/float_image.h"

namespace relume {

/// What a texel of a KTX2 texture is made of. The numbers are those of VkFormat.
enum class Ktx2Format : uint32_t {
    Half = 97,            // VK_FORMAT_R16G16B16A16_SFLOAT, 8 bytes, alpha 1
    SharedExponent = 123, // VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, 4 bytes, colours from 0 to 65408
};

struct Ktx2Desc {
    Ktx2Format format = Ktx2Format::Half;
    bool zstd = true;   // supercompressed by Zstandard
    uint32_t depth = 1; // slices of a 3D texture, one beneath another in the image; 1: a 2D picture
};

/// Returns R, G and B of an image as a KTX 2.0 file [Khronos, KTX File Format Specification 2.0]: one level,
/// linear Rec. 709, row 0 on top, in a 3D texture at the bottom. Values beyond the format's range are cut
/// with a warning, which names the image `name`. Equal images give equal bytes. Throws Error without these
/// channels.
std::string encodeKtx2(const FloatImage& image, const Ktx2Desc& desc, const std::string& name);

/// Returns R, G and B of the first level of such a file, in one of the two formats above. Throws
/// std::runtime_error where it is broken or of another kind, and Error, naming the file `path`, where it has
/// more than `mostPixels`.
FloatImage decodeKtx2(const std::string& bytes, const std::string& path, uint64_t mostPixels);

} // namespace relume
