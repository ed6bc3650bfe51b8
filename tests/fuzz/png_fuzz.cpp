// A PNG is read as a lightmap or picture, and PNG and JPEG as an image of a scene.
#include "assets/base/error.h"
#include "assets/gltf/gltf_build.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/glb_builder.h"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace relume::fuzz {
namespace {

void append(void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(size));
}

} // namespace

std::vector<std::string> corpus() {
    std::vector<std::string> corpus;
    corpus.emplace_back(test::kTwoPixels.begin(), test::kTwoPixels.end());
    corpus.emplace_back(test::kTwoPixels.begin(), test::kTwoPixels.end() - 12); // without its end
    std::string pixels;
    for (int i = 0; i < 19 * 17 * 4; ++i)
        pixels += static_cast<char>(i * i % 251);
    for (int channels = 1; channels <= 4; ++channels) {
        stbi_write_png_to_func(append, &corpus.emplace_back(), 19, 17, channels, pixels.data(), 0);
        stbi_write_jpg_to_func(append, &corpus.emplace_back(), 19, 17, channels, pixels.data(),
                               50 + 15 * channels);
    }
    std::string large = corpus.front();
    large.replace(16, 8, std::string("\0\0\x60\0\0\0\x60\0", 8)); // 24576 x 24576 pixels
    corpus.push_back(large);
    corpus.emplace_back("P5 99999999999999999999 1 255 ."); // of a kind that no scene has
    return corpus;
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace relume;
    const std::string path = fuzz::asFile(data, size, ".png");
    try {
        readImage(path);
    } catch (const Error& error) {
        fuzz::checkMessage(error, path);
    }
    gltf::Build build;
    build.path = path;
    build.limit = gltf::SizeLimit(path, size);
    build.images = nlohmann::json::array({{{"bufferView", 0}}});
    build.model.bufferViews.resize(1);
    build.model.bufferViews[0].buffer = 0;
    build.model.bufferViews[0].byteLength = size;
    build.model.buffers.resize(1);
    build.model.buffers[0].data.assign(data, data + size);
    try {
        gltf::decodeImage(build, 0);
    } catch (const Error& error) {
        fuzz::checkMessage(error, path);
    }
    return 0;
}
