#include "assets/base/error.h"
#include "assets/images/layered_exr.h"
#include "tests/fuzz/exr_corpus.h"

namespace relume::fuzz {
namespace {

FloatImage colors(uint32_t width, uint32_t height) {
    FloatImage image{width, height, {}, {}, {}};
    float value = 0;
    for (const char* channel : {"R", "G", "B"})
        for (float& texel : image.add(channel))
            texel = value += 0.125f;
    return image;
}

std::string layered(size_t layers, ExrType type) {
    LayeredImage image;
    image.composite = colors(5, 3);
    image.composite.add("coverage");
    for (size_t i = 0; i < layers; ++i)
        image.layers.push_back({"Lamp " + std::to_string(i),
                                {1, 2, 3},
                                {{layer_attribute::kType, "point"}, {layer_attribute::kIntensity, "40"}},
                                colors(5, 3)});
    const std::string path = besideInputs("layers.exr");
    writeLayeredExr(path, image, type);
    return contentOf(path);
}

} // namespace

std::vector<std::string> corpus() {
    std::vector<std::string> corpus = claimingExrs();
    for (const size_t layers : {0u, 1u, 3u})
        for (const ExrType type : {ExrType::Float, ExrType::Half})
            corpus.push_back(layered(layers, type));
    return corpus;
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string path = relume::fuzz::asFile(data, size, ".exr");
    try {
        relume::readLayeredExr(path);
    } catch (const relume::Error& error) {
        relume::fuzz::checkMessage(error, path);
    }
    return 0;
}
