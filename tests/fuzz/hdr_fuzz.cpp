#include "assets/base/error.h"
#include "assets/images/sky_picture.h"
#include "tests/fuzz/fuzz.h"

namespace relume::fuzz {

std::vector<std::string> corpus() {
    const std::string header = "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n";
    const std::string pixel("\x80\x40\x00\x81", 4), same("\x01\x01\x01\x02", 4);
    const std::string run("\x02\x02\x00\x0a\x8a\x07\x8a\x07\x8a\x07\x8a\x81", 12);
    const std::string bytes("\x02\x02\x00\x08\x08"
                            "12345678\x08"
                            "12345678\x88\x05\x84\x81\x04\x81\x82\x83\x84",
                            32);
    return {header + "-Y 2 +X 2\n" + pixel + pixel + pixel + pixel,
            header + "-Y 1 +X 3\n" + pixel + same,
            header + "-Y 2 +X 10\n" + run + run,
            header + "-Y 1 +X 8\n" + bytes,
            "#?RGBE\n\n-Y 1 +X 1\n" + pixel,
            header + "-Y 4294967295 +X 4294967295\n",
            header + "-Y 30000 +X 30000\n" + pixel + std::string(60, '\1')};
}

} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    relume::Sky sky;
    sky.file = relume::fuzz::asFile(data, size, ".hdr");
    try {
        relume::readSkyPicture(sky);
    } catch (const relume::Error& error) {
        relume::fuzz::checkMessage(error, sky.file);
    }
    return 0;
}
