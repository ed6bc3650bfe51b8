#include "assets/foreign/foreign_picture.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/images/png_check.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

// This is our own static copy, which reads more kinds of pictures than the others. Nobody but the child
// process that converts files calls it.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_MAX_DIMENSIONS 32768
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored                                                                               \
    "-Wmaybe-uninitialized" // stb's PNG reader refuses a file before it would read that
#pragma GCC diagnostic ignored "-Wunused-function" // readers of floats
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace relume::foreign {
namespace {

// A picture beyond that is none that a material of a scene has [bytes of its file; pixels].
constexpr uint64_t kMostBytes = uint64_t{1} << 30, kMostPixels = uint64_t{1} << 28;

bool isPng(const std::vector<uint8_t>& bytes) {
    return bytes.size() > 8 && std::memcmp(bytes.data(), "\x89PNG\r\n\x1a\n", 8) == 0;
}

bool isJpeg(const std::vector<uint8_t>& bytes) {
    return bytes.size() > 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff;
}

bool isWholePng(const std::vector<uint8_t>& bytes) {
    return isPng(bytes) &&
           findPngDamage({reinterpret_cast<const char*>(bytes.data()), bytes.size()}).problem.empty();
}

bool hasAlpha(const Image& image) {
    for (size_t i = 3; i < image.rgba.size(); i += 4)
        if (image.rgba[i] != 255) return true;
    return false;
}

} // namespace

bool Pictures::decode(Picture& picture) const {
    const int size = static_cast<int>(picture.bytes.size());
    int width = 0, height = 0, channels = 0;
    if (!stbi_info_from_memory(picture.bytes.data(), size, &width, &height, &channels)) return false;
    if (width <= 0 || height <= 0) return false;
    if (static_cast<uint64_t>(width) * static_cast<uint64_t>(height) > kMostPixels) return false;
    stbi_uc* pixels = stbi_load_from_memory(picture.bytes.data(), size, &width, &height, &channels, 4);
    if (!pixels) return false;
    picture.image.width = static_cast<uint32_t>(width);
    picture.image.height = static_cast<uint32_t>(height);
    picture.image.rgba.assign(pixels, pixels + size_t{4} * picture.image.width * picture.image.height);
    stbi_image_free(pixels);
    picture.asItIs = isWholePng(picture.bytes) || isJpeg(picture.bytes);
    return true;
}

bool Pictures::readEmbedded(const aiTexture& texture, Picture& picture) const {
    if (!texture.pcData || texture.mWidth == 0) return false;
    if (texture.mHeight == 0) { // a file in the file
        const auto* bytes = reinterpret_cast<const uint8_t*>(texture.pcData);
        picture.bytes.assign(bytes, bytes + texture.mWidth);
        return decode(picture);
    }
    if (uint64_t{texture.mWidth} * texture.mHeight > kMostPixels) return false;
    picture.image.width = texture.mWidth;
    picture.image.height = texture.mHeight;
    const size_t count = size_t{texture.mWidth} * texture.mHeight;
    picture.image.rgba.reserve(4 * count);
    for (size_t i = 0; i < count; ++i) {
        const aiTexel& texel = texture.pcData[i];
        picture.image.rgba.insert(picture.image.rgba.end(), {texel.r, texel.g, texel.b, texel.a});
    }
    return true;
}

bool Pictures::read(const std::string& reference, const std::string& material, Picture& picture) {
    const auto refuse = [&](const std::string& problem) {
        build_.warnings.add("material " + inQuotes(material), problem);
        return false;
    };
    const std::string file =
        std::filesystem::path(reference.substr(reference.find_last_of("/\\") + 1)).filename().string();
    picture.image.name = std::filesystem::path(file).stem().string();
    if (const aiTexture* texture = build_.source->GetEmbeddedTexture(reference.c_str())) {
        picture.key = "*" + reference;
        return readEmbedded(*texture, picture) || refuse("has an embedded picture, " + inQuotes(reference) +
                                                         ", that cannot be decoded: its colour is used");
    }
    if (build_.ending == ".blend" && reference.starts_with("Procedural,")) // as libassimp calls them
        return refuse("has a texture that Blender computes: its colour is used");
    const std::string path = build_.near.find(reference);
    if (path.empty())
        return refuse("wants the picture " + inQuotes(reference) +
                      ", which is not in the folder of the file or near it: its colour is used");
    picture.key = path;
    try {
        RegularFile source(path, "name a picture");
        if (source.size() > kMostBytes) return refuse(inQuotes(path) + " is too large: its colour is used");
        picture.bytes.resize(source.size());
        source.read(picture.bytes.data(), picture.bytes.size());
    } catch (const Error&) {
        return refuse("wants the picture " + inQuotes(path) + ", which cannot be read: its colour is used");
    }
    return decode(picture) || refuse("wants the picture " + inQuotes(path) +
                                     ", which cannot be decoded: save it as PNG or JPEG; its colour is used");
}

int Pictures::add(Image image, std::vector<uint8_t> bytes) {
    if (!bytes.empty()) image.rgba = {};
    build_.made.scene.images.push_back(std::move(image));
    build_.made.pictures.push_back(std::move(bytes));
    return static_cast<int>(build_.made.scene.images.size()) - 1;
}

int Pictures::image(const std::string& reference, const std::string& material) {
    const auto [known, isNew] = images_.try_emplace("=" + reference, -1);
    if (!isNew) return known->second;
    Picture picture;
    if (!read(reference, material, picture)) return -1;
    const auto [same, isFirst] = images_.try_emplace(picture.key, -1);
    if (isFirst)
        same->second =
            add(std::move(picture.image), picture.asItIs ? std::move(picture.bytes) : std::vector<uint8_t>());
    return known->second = same->second;
}

Pictures::Masked Pictures::imageWithAlpha(const std::string& reference, const std::string& alpha,
                                          const std::string& material) {
    Picture color, mask;
    if (!read(reference, material, color)) return {};
    if (!read(alpha, material, mask)) return {image(reference, material)};
    const bool own = hasAlpha(mask.image);
    // A picture that is named for both and has no alpha of its own tells nothing.
    if (color.key == mask.key && !own) return {image(reference, material)};
    const auto [known, isNew] = withAlpha_.try_emplace({color.key, mask.key}, -1);
    if (!isNew) return {known->second, true};
    Image& image = color.image;
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) {
            const size_t row = uint64_t{y} * mask.image.height / image.height;
            const size_t column = uint64_t{x} * mask.image.width / image.width;
            const uint8_t* texel = &mask.image.rgba[4 * (row * mask.image.width + column)];
            image.rgba[4 * (size_t{y} * image.width + x) + 3] = own ? texel[3] : texel[0];
        }
    known->second = add(std::move(image), {});
    return {known->second, true};
}

} // namespace relume::foreign
