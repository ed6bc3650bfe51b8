#include "assets/gltf/gltf_kept.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/uri.h"
#include "assets/decode/webp.h"
#include "assets/gltf/gltf_build.h"
#include "assets/gltf/gltf_png.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace relume::gltf {
namespace {

constexpr size_t kHead = 12; // that tell what a picture is [bytes]

bool isPngOrJpeg(std::span<const uint8_t> bytes) {
    constexpr std::array<uint8_t, 8> kPng = {0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};
    constexpr std::array<uint8_t, 3> kJpeg = {0xff, 0xd8, 0xff};
    const auto begins = [&](std::span<const uint8_t> with) {
        return bytes.size() >= with.size() && std::equal(with.begin(), with.end(), bytes.begin());
    };
    return begins(kPng) || begins(kJpeg);
}

bool isPicture(std::span<const uint8_t> bytes) {
    return isPngOrJpeg(bytes) || isWebp(bytes);
}

std::vector<uint8_t> readFile(const std::string& path, uint64_t most) {
    RegularFile file(path, "put the image there that the scene names");
    std::vector<uint8_t> bytes(std::min(most, file.size()));
    file.read(bytes.data(), bytes.size());
    return bytes;
}

} // namespace

bool keepImage(const Build& build, size_t image, KeptTexture& texture) {
    const nlohmann::json& source = build.images[image];
    texture.name = source.value("name", "");
    const std::string uri = source.value("uri", "");
    if (uri.empty() || uri.starts_with("data:")) {
        std::string problem;
        std::vector<uint8_t> bytes = imageBytes(build, source, problem);
        if (!isPicture(bytes)) return false;
        texture.file = std::move(bytes);
        return true;
    }
    texture.path = pathOfUri(build.path, uri);
    try {
        return isPicture(readFile(texture.path, kHead));
    } catch (const Error&) {
        return false;
    }
}

std::vector<uint8_t> keptPicture(const KeptTexture& texture) {
    std::vector<uint8_t> bytes = texture.path.empty() ? texture.file : readFile(texture.path, UINT64_MAX);
    if (isPngOrJpeg(bytes)) return bytes;
    const std::optional<WebpSize> size = webpSize(bytes);
    std::optional<std::vector<uint8_t>> pixels = decodeWebp(bytes);
    if (!size || !pixels)
        throw Error((texture.path.empty() ? "image " + inQuotes(texture.name) : texture.path) +
                    ": is no PNG, JPEG or WebP picture: export it again");
    return encodePng({texture.name, size->width, size->height, std::move(*pixels)});
}

} // namespace relume::gltf
