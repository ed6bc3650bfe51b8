// A KTX 2.0 file is read wherever an image is.
#include "assets/base/error.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/ktx2.h"
#include "tests/fuzz/fuzz.h"

#include <cmath>

namespace relume::fuzz {

std::vector<std::string> corpus() {
    FloatImage image{5, 3, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        for (float& value : image.add(channel))
            value = std::exp2(static_cast<float>(&value - image.planes.back().data()) - 7.0f);
    std::vector<std::string> corpus;
    for (const Ktx2Format format : {Ktx2Format::Half, Ktx2Format::SharedExponent})
        for (const bool zstd : {false, true})
            corpus.push_back(encodeKtx2(image, {.format = format, .zstd = zstd}, "corpus"));
    constexpr size_t kSize = 20;                       // bytes before width and height
    for (const size_t kind : {size_t{0}, size_t{1}}) { // 24576 x 24576 pixels that are not there
        std::string large = corpus[kind];
        large.replace(kSize, 8, std::string("\0\x60\0\0\0\x60\0\0", 8));
        corpus.push_back(large);
    }
    corpus.push_back(corpus.front().substr(0, corpus.front().size() - 1)); // without its end
    return corpus;
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string path = relume::fuzz::asFile(data, size, ".ktx2");
    try {
        const relume::FloatImage image = relume::readImage(path);
        for (const std::vector<float>& plane : image.planes)
            relume::fuzz::check(plane.size() == size_t{image.width} * image.height,
                                "a plane has another size");
    } catch (const relume::Error& error) {
        relume::fuzz::checkMessage(error, path);
    }
    return 0;
}
