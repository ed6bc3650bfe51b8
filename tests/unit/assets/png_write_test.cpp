#include "assets/images/png_write.h"

#include "assets/images/image_file.h"
#include "assets/images/png_check.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <utility>

namespace relume {
namespace {

/// Returns RGB pixels, half of them noise, which no filter foretells, and half of them smooth.
std::string somePixels(uint32_t width, uint32_t height) {
    std::mt19937 random(3);
    std::string pixels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < 3 * width; ++x)
            pixels += char(uint8_t(y < height / 2 ? random() : (x * x + 3 * y) / 64));
    return pixels;
}

void expectSame(const std::string& png, const std::string& pixels, uint32_t width, uint32_t height) {
    const TemporaryFolder folder;
    const std::string path = folder.path("a.png");
    std::ofstream(path, std::ios::binary) << png;
    EXPECT_EQ(findPngDamage(png).problem, "");
    const FloatImage image = readImage(path);
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, height);
    EXPECT_EQ(encodeSrgb(image, "a"), pixels);
}

TEST(PngWrite, EveryPixelComesBack) {
    // One pixel; less than a band, one wide row a band; several bands, the last one short.
    for (const auto& [width, height] :
         {std::pair(1u, 1u), {3u, 2u}, {1u, 700u}, {100000u, 3u}, {640u, 480u}, {517u, 1031u}}) {
        SCOPED_TRACE(width);
        const std::string pixels = somePixels(width, height);
        expectSame(writePng(pixels, width, height, 3, "a"), pixels, width, height);
    }
}

TEST(PngWrite, TheNumberOfThreadsChangesNoByte) {
    const char* before = std::getenv("RELUME_THREADS");
    const std::string old = before ? before : "", pixels = somePixels(800, 600);
    setenv("RELUME_THREADS", "1", 1);
    const std::string alone = writePng(pixels, 800, 600, 3, "a");
    setenv("RELUME_THREADS", "7", 1);
    EXPECT_EQ(writePng(pixels, 800, 600, 3, "a"), alone);
    before ? setenv("RELUME_THREADS", old.c_str(), 1) : unsetenv("RELUME_THREADS");
}

TEST(PngWrite, SmoothPicturesAreSmall) {
    std::string pixels;
    for (uint32_t y = 0; y < 512; ++y)
        for (uint32_t x = 0; x < 512; ++x)
            pixels += char(uint8_t((x + y) / 4));
    EXPECT_LT(writePng(pixels, 512, 512, 1, "grey").size(), pixels.size() / 50);
}

TEST(PngWrite, BandsKnowWhatCameBefore) {
    // Rows that repeat a noise of 24 KiB: each is but a copy, across the bands' edges, too.
    const std::string row = somePixels(8192, 2).substr(0, 8192 * 3);
    std::string pixels;
    for (int y = 0; y < 64; ++y)
        pixels += row;
    EXPECT_LT(writePng(pixels, 8192, 64, 3, "noise").size(), row.size() * 3 / 2);
}

} // namespace
} // namespace relume
