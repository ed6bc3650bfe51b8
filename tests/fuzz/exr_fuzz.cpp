#include "assets/base/error.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/fuzz/exr_corpus.h"

namespace relume::fuzz {

std::vector<std::string> corpus() {
    std::vector<std::string> corpus = claimingExrs();
    for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression)
        for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT})
            for (const bool tiled : {false, true})
                corpus.push_back(exrRamp(static_cast<Imf::Compression>(compression), type, tiled));
    return corpus;
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string path = relume::fuzz::asFile(data, size, ".exr");
    try {
        relume::readImage(path);
    } catch (const relume::Error& error) {
        relume::fuzz::checkMessage(error, path);
    }
    return 0;
}
