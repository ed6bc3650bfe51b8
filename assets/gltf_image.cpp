#include "assets/error.h"
#include "assets/file_read.h"
#include "assets/gltf_build.h"
#include "assets/png_check.h"

// Our own static copy, of which only the sizes of pictures are asked; the parser's decodes.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#include <stb_image.h>

#include <spdlog/fmt/fmt.h>

#include <limits>

namespace relume::gltf {

namespace {

using Bytes = std::vector<unsigned char>;

// Pixels per byte. JPEG has at least two bits for 64 pixels of one channel, or one in a progressive file. Of
// all others PNG packs best: DEFLATE makes 1032 bytes of one, each of eight pixels.
constexpr uint64_t kMostJpegPacking = 1024, kMostPacking = 8 * 1040;

bool isJpeg(const Bytes& bytes) {
    return bytes.size() > 2 && bytes[0] == 0xff && bytes[1] == 0xd8;
}

/// Counts the pixels before a decoder takes memory for them; false where the bytes cannot be a picture of the
/// size that they tell.
bool countTexels(SizeLimit& limit, const Bytes& bytes) {
    if (bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max())) return false;
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels))
        return false;
    const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
    if (pixels / (isJpeg(bytes) ? kMostJpegPacking : kMostPacking) > bytes.size()) return false;
    limit.addTexels(4 * pixels);
    return true;
}

/// To 8-bit RGBA; false where the bytes are no such image.
bool decode(const Bytes& bytes, int index, Image& image) {
    tinygltf::Image decoded;
    std::string error, warning;
    const bool good = tinygltf::LoadImageData(&decoded, index, &error, &warning, 0, 0, bytes.data(),
                                              static_cast<int>(bytes.size()), nullptr);
    if (!good || decoded.width <= 0 || decoded.height <= 0) return false;
    image.width = static_cast<uint32_t>(decoded.width);
    image.height = static_cast<uint32_t>(decoded.height);
    const size_t values = size_t(image.width) * image.height * 4;
    if (decoded.component != 4 || decoded.image.size() < values * static_cast<size_t>(decoded.bits / 8))
        return false;
    if (decoded.bits == 8) {
        image.rgba = std::move(decoded.image);
        image.rgba.resize(values);
        return true;
    }
    image.rgba.resize(values);
    for (size_t i = 0; i < values; ++i)
        image.rgba[i] = decoded.image[2 * i + 1]; // the high byte of 16 bits
    return true;
}

/// Why there are no bytes of an image.
std::string absence(const std::string& gltfPath, const tinygltf::Image& source) {
    const std::string path = source.uri.empty() ? "" : pathOfUri(gltfPath, source.uri);
    const std::string kind = path.empty() ? "" : oddKindOf(path);
    return kind.empty() ? "is missing or empty" : kind;
}

} // namespace

bool keepImageBytes(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                    const unsigned char* bytes, int size, void*) {
    image->image.assign(bytes, bytes + size);
    return true;
}

Image decodeImage(Build& build, int index) {
    tinygltf::Image& source = build.model.images[static_cast<size_t>(index)];
    const std::string where = source.uri.empty() ? fmt::format("image {} {}", index, inQuotes(source.name))
                                                 : fmt::format("image file {}", inQuotes(source.uri));
    if (source.image.empty())
        throw Error(fmt::format("{}: {} {}: put it beside the scene or export with embedded images",
                                build.path, where, absence(build.path, source)));
    PngDamage damage =
        findPngDamage({reinterpret_cast<const char*>(source.image.data()), source.image.size()});
    if (!damage.problem.empty())
        build.warnings.add(where, "is damaged (" + damage.problem + "): export it again");
    if (!damage.mended.empty()) source.image.assign(damage.mended.begin(), damage.mended.end());
    Image image;
    image.name = source.name;
    if (!countTexels(build.limit, source.image) || !decode(source.image, index, image))
        throw Error(
            fmt::format("{}: {} cannot be decoded: export textures as PNG or JPEG", build.path, where));
    source.image = {}; // no other use of it is decoded again
    return image;
}

} // namespace relume::gltf
