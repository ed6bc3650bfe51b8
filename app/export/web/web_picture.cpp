#include "app/export/web/web_picture.h"

#include "assets/base/error.h"
#include "assets/images/image_file.h"

#include <fmt/format.h>
#include <webp/encode.h>

namespace relume {
namespace {

static_assert(kMostWebp == WEBP_MAX_DIMENSION);
constexpr float kFrameQuality = 85.0f;
constexpr float kFastPacking = 50.0f; // of a picture without loss, from 0 to 100

std::string encoded(const WebPConfig& config, const std::string& name, uint32_t width, uint32_t height,
                    bool (*import)(WebPPicture&, const void*), const void* pixels) {
    WebPPicture picture;
    if (!WebPPictureInit(&picture)) throw Error("the library for WebP is not the one that it was built with");
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    picture.use_argb = config.lossless;
    picture.width = static_cast<int>(width);
    picture.height = static_cast<int>(height);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    const bool good = import(picture, pixels) && WebPEncode(&config, &picture);
    std::string out(reinterpret_cast<const char*>(writer.mem), good ? writer.size : 0);
    WebPPictureFree(&picture);
    WebPMemoryWriterClear(&writer);
    if (good) return out;
    throw Error(
        fmt::format("{}: cannot be written as WebP, which takes at most {} x {} pixels: make it smaller",
                    name, kMostWebp, kMostWebp));
}

} // namespace

std::string webpOf(const Image& image) {
    WebPConfig config;
    if (!WebPConfigInit(&config)) throw Error("the library for WebP is not the one that it was built with");
    config.lossless = 1;
    config.exact = 1;
    config.quality = kFastPacking;
    return encoded(
        config, "texture '" + image.name + "'", image.width, image.height,
        [](WebPPicture& to, const void* pixels) {
            return WebPPictureImportRGBA(&to, static_cast<const uint8_t*>(pixels), 4 * to.width) != 0;
        },
        image.rgba.data());
}

std::string smallWebpOf(const FloatImage& image, const std::string& name) {
    WebPConfig config;
    if (!WebPConfigInit(&config)) throw Error("the library for WebP is not the one that it was built with");
    config.quality = kFrameQuality;
    const std::string pixels = encodeSrgb(image, name);
    return encoded(
        config, name, image.width, image.height,
        [](WebPPicture& to, const void* rgb) {
            return WebPPictureImportRGB(&to, static_cast<const uint8_t*>(rgb), 3 * to.width) != 0;
        },
        pixels.data());
}

} // namespace relume
