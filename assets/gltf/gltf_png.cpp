#include "assets/gltf/gltf_png.h"

#include "assets/base/error.h"

// These functions are private to this file: tinygltf and others may bring the same ones.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

namespace relume::gltf {

std::vector<uint8_t> encodePng(const Image& image) {
    if (image.width == 0 || image.height == 0 || image.rgba.size() != size_t{4} * image.width * image.height)
        throw Error("image '" + image.name + "' has no pixels: remove it or load its file");
    bool opaque = true;
    for (size_t i = 3; i < image.rgba.size(); i += 4)
        opaque = opaque && image.rgba[i] == 255;
    const int channels = opaque ? 3 : 4;
    std::vector<uint8_t> pixels;
    pixels.reserve(image.rgba.size());
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        pixels.insert(pixels.end(), image.rgba.begin() + i, image.rgba.begin() + i + channels);
    std::vector<uint8_t> png;
    const auto append = [](void* context, void* data, int size) {
        auto* out = static_cast<std::vector<uint8_t>*>(context);
        out->insert(out->end(), static_cast<uint8_t*>(data), static_cast<uint8_t*>(data) + size);
    };
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    if (!stbi_write_png_to_func(append, &png, width, height, channels, pixels.data(), width * channels))
        throw Error("image '" + image.name + "' cannot be written as PNG: out of memory");
    return png;
}

} // namespace relume::gltf
