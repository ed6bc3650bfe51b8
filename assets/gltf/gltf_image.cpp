#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/uri.h"
#include "assets/decode/webp.h"
#include "assets/gltf/gltf_build.h"
#include "assets/gltf/file/gltf_value.h"
#include "assets/images/png_check.h"

// This is our own static copy, which is asked for the sizes of pictures only; the parser's copy decodes. glTF
// knows PNG, JPEG and, by extensions, WebP, which libwebp decodes. What else stb would read is refused here,
// since integers overflow in its other readers.
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

using nlohmann::json;
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

/// Returns the pixels of a picture as its header tells them, or 0 where the bytes cannot be a picture of that
/// size.
uint64_t pixelsOf(const Bytes& bytes) {
    // WebP needs no bytes at all for a picture of one colour, so that only the bound on all pixels holds it.
    if (const std::optional<WebpSize> size = webpSize(bytes)) return uint64_t{size->width} * size->height;
    if (bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max())) return 0;
    const size_t jpeg = jpegBegin(bytes);
    if (jpeg > 0 && !hasSafeTables(bytes, jpeg)) return 0;
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height, &channels))
        return 0;
    const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
    return pixels / (jpeg > 0 ? kMostJpegPacking : kMostPngPacking) > bytes.size() ? 0 : pixels;
}

bool decodeWebpInto(const Bytes& bytes, Image& image) {
    const std::optional<WebpSize> size = webpSize(bytes);
    std::optional<std::vector<uint8_t>> pixels = decodeWebp(bytes);
    if (!size || !pixels) return false;
    image.width = size->width;
    image.height = size->height;
    image.rgba = std::move(*pixels);
    return true;
}

/// Decodes to 8-bit RGBA. Returns false where the bytes are no such image.
bool decode(const Bytes& bytes, int index, Image& image) {
    if (isWebp(bytes)) return decodeWebpInto(bytes, image);
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

} // namespace

std::vector<unsigned char> imageBytes(const Build& build, const json& source, std::string& problem) {
    Bytes bytes;
    problem = "is missing or empty";
    const int view = indexBelow(source, "bufferView", build.model.bufferViews.size());
    const std::string uri = source.value("uri", "");
    if (view >= 0) {
        const tinygltf::BufferView& from = build.model.bufferViews[static_cast<size_t>(view)];
        const Bytes& data = build.model.buffers[static_cast<size_t>(from.buffer)].data;
        const size_t begin = std::min(from.byteOffset, data.size());
        const auto at = data.begin() + static_cast<std::ptrdiff_t>(begin);
        bytes.assign(at, at + static_cast<std::ptrdiff_t>(std::min(from.byteLength, data.size() - begin)));
    } else if (uri.starts_with("data:")) {
        bytes = bytesOfDataUri(uri).value_or(Bytes());
    } else if (!uri.empty()) {
        const std::string path = pathOfUri(build.path, uri), kind = oddKindOf(path);
        if (!kind.empty()) problem = kind;
        try {
            RegularFile file(path, "name an image");
            bytes.resize(file.size());
            file.read(bytes.data(), bytes.size());
        } catch (const Error&) {
            bytes.clear(); // the problem stands above
        }
    }
    return bytes;
}

std::optional<Image> decodeImage(Build& build, size_t index) {
    const json& source = build.images[index];
    const std::string uri = source.value("uri", ""), name = source.value("name", "");
    const bool named = !uri.empty() && !uri.starts_with("data:");
    const std::string where = named ? fmt::format("image file {}", inQuotes(decodedUri(uri)))
                                    : fmt::format("image {} {}", index, inQuotes(name));
    std::string problem;
    Bytes bytes = imageBytes(build, source, problem);
    if (bytes.empty()) {
        build.warnings.add(where, problem + ", materials use their factors alone: put it beside the scene or "
                                            "export with embedded images");
        return std::nullopt;
    }
    PngDamage damage = findPngDamage({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (!damage.mended.empty()) bytes.assign(damage.mended.begin(), damage.mended.end());
    Image image;
    image.name = name;
    const uint64_t pixels = pixelsOf(bytes);
    build.limit.addTexels(4 * pixels);
    if (pixels == 0 || !decode(bytes, static_cast<int>(index), image)) {
        build.warnings.add(where, "cannot be decoded, materials use their factors alone: export textures as "
                                  "PNG, JPEG or WebP");
        return std::nullopt;
    }
    if (!damage.problem.empty())
        build.warnings.add(where, "is damaged (" + damage.problem + "): export it again");
    return image;
}

} // namespace relume::gltf
