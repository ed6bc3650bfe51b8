#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/gltf/gltf_build.h"
#include "assets/images/png_check.h"

// This is our own static copy, which is asked for the sizes of pictures only; the parser's copy decodes. glTF
// knows only PNG and JPEG; what else stb would read is refused here, since integers overflow in its other
// readers.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored                                                                               \
    "-Wmaybe-uninitialized" // stb's PNG reader refuses a file before it would read that
#include <stb_image.h>
#pragma GCC diagnostic pop

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>

namespace relume::gltf {

namespace {

using Bytes = std::vector<unsigned char>;

// These bound the pixels per byte. JPEG has at least two bits for 64 pixels of one channel, or one in a
// progressive file. PNG's DEFLATE makes 1032 bytes of one, each of eight pixels.
constexpr uint64_t kMostJpegPacking = 1024, kMostPngPacking = 8 * 1040;

/// Returns where a JPEG's segments begin, behind its first marker, which fill bytes may precede; 0 where it
/// is no JPEG.
size_t jpegBegin(const Bytes& bytes) {
    size_t at = 0;
    while (at < bytes.size() && bytes[at] == 0xff)
        ++at;
    return at > 0 && at < bytes.size() && bytes[at] == 0xd8 ? at + 1 : 0;
}

/// Tells whether the table of Huffman codes at `at` (its class and number, then 16 counts) has more codes
/// than there are byte values; moves `at` to the next table.
bool hasTooManyCodes(const Bytes& bytes, size_t& at, size_t end) {
    size_t codes = 0;
    for (size_t i = at + 1; i < std::min(at + 17, end); ++i)
        codes += bytes[i];
    at += 17 + codes;
    return codes > 256;
}

/// Tells whether stb can read the tables: it (2.27) writes codes beyond its table's end where a file has more
/// than 256 of them. The tables in the file's segments are looked at, and behind the first pixels whatever
/// may be one: there stb goes on at any byte.
bool hasSafeTables(const Bytes& bytes, size_t begin) {
    constexpr uint8_t kTables = 0xc4, kEnd = 0xd9, kPixels = 0xda;
    bool segments = true;
    for (size_t at = begin; at + 3 < bytes.size();) {
        const uint8_t marker = bytes[at + 1];
        if (bytes[at] != 0xff || marker == 0xff) {
            ++at;
            continue;
        }
        if (marker == kEnd) return true; // what follows is nobody's
        const size_t end = at + 2 + (size_t{bytes[at + 2]} << 8 | bytes[at + 3]);
        if (marker == kTables)
            for (size_t table = at + 4; table < std::min(end, bytes.size());)
                if (hasTooManyCodes(bytes, table, bytes.size())) return false;
        if (marker == kPixels) segments = false;
        at = segments ? std::max(end, at + 2) : at + 2;
    }
    return true;
}

/// Counts the pixels before a decoder takes memory for them. Returns false where the bytes cannot be a
/// picture of the size that they tell.
bool countTexels(SizeLimit& limit, const Bytes& bytes) {
    if (bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max())) return false;
    const size_t jpeg = jpegBegin(bytes);
    if (jpeg > 0 && !hasSafeTables(bytes, jpeg)) return false;
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels))
        return false;
    const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
    if (pixels / (jpeg > 0 ? kMostJpegPacking : kMostPngPacking) > bytes.size()) return false;
    limit.addTexels(4 * pixels);
    return true;
}

/// Decodes to 8-bit RGBA. Returns false where the bytes are no such image.
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

/// Tells why there are no bytes of an image.
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
