#include "assets/images/sky_picture.h"

#include "assets/base/error.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace relume {
namespace {

// This allows 11585 x 5793 pixels: 0.03 degrees a pixel, a seventeenth of the sun's disc, for 768 MiB of
// pixels.
constexpr uint64_t kMostSkyPixels = uint64_t(64) << 20;
// Shaders get width and height in 16 bits each (LampPush::skySize).
constexpr uint32_t kMostSkyEdge = 65535;

bool isFloatFormat(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return ending == ".exr" || ending == ".hdr";
}

/// Makes all pixels finite and not negative, and returns how many had to be corrected.
size_t mend(std::vector<glm::vec3>& pixels) {
    float largest = 0.0f;
    for (const glm::vec3& pixel : pixels)
        for (int c = 0; c < 3; ++c)
            if (std::isfinite(pixel[c])) largest = std::max(largest, pixel[c]);
    size_t mended = 0;
    for (glm::vec3& pixel : pixels) {
        bool good = true;
        for (int c = 0; c < 3; ++c) {
            if (std::isfinite(pixel[c]) && pixel[c] >= 0.0f) continue;
            pixel[c] = pixel[c] > 0.0f ? largest : 0.0f;
            good = false;
        }
        mended += !good;
    }
    return mended;
}

} // namespace

std::vector<std::string> readSkyPicture(Sky& sky) {
    if (!isFloatFormat(sky.file))
        throw Error(sky.file + ": a sky's picture must be an .exr or .hdr file: convert it");
    FloatImage image = readImage(sky.file, kMostSkyPixels);
    if (std::max(image.width, image.height) > kMostSkyEdge)
        throw Error(fmt::format("{}: has {} x {} pixels, more than {} along one side: scale it down",
                                sky.file, image.width, image.height, kMostSkyEdge));
    sky.width = image.width;
    sky.height = image.height;
    sky.pixels.assign(size_t{image.width} * image.height, glm::vec3(0.0f));
    for (int c = 0; c < 3; ++c) {
        const std::vector<float>* plane = image.find(std::string(1, "RGB"[c]));
        if (!plane)
            throw Error(fmt::format("{}: has no channel {}: save it with R, G and B", sky.file, "RGB"[c]));
        for (size_t i = 0; i < sky.pixels.size(); ++i)
            sky.pixels[i][c] = (*plane)[i];
    }
    std::vector<std::string> warnings;
    if (sky.width != 2 * sky.height)
        warnings.push_back(fmt::format("is {} x {}, not twice as wide as high: it is stretched over the sky",
                                       sky.width, sky.height));
    if (const size_t mended = mend(sky.pixels))
        warnings.push_back(fmt::format("{} of its {} pixels are negative, infinite or not numbers: 0 or the "
                                       "largest finite value is used",
                                       mended, sky.pixels.size()));
    return warnings;
}

void readEditedPicture(Sky& sky) {
    if (sky.file.empty() || !sky.pixels.empty()) return;
    readSkyPicture(sky);
    limitSky(sky);
}

} // namespace relume
