// Pictures that are made smaller for a device: each pixel is the mean of what it covers.
#include "assets/images/box_filter.h"
#include "assets/images/float_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace relume {
namespace {

Image imageOf(uint32_t width, uint32_t height, const std::vector<std::array<uint8_t, 4>>& pixels) {
    Image image{"picture", width, height, {}};
    for (const std::array<uint8_t, 4>& pixel : pixels)
        image.rgba.insert(image.rgba.end(), pixel.begin(), pixel.end());
    return image;
}

TEST(BoxFilter, APixelIsTheMeanOfThoseThatItCovers) {
    const Image image = imageOf(4, 2,
                                {{0, 10, 20, 30},
                                 {2, 10, 20, 50},
                                 {7, 7, 7, 7},
                                 {9, 7, 7, 7},
                                 {4, 20, 20, 70},
                                 {6, 20, 20, 90},
                                 {7, 7, 7, 7},
                                 {9, 7, 7, 7}});
    const Image small = shrunkTo(2, image, false);
    EXPECT_EQ(small.name, "picture");
    EXPECT_EQ(small.width, 2u);
    EXPECT_EQ(small.height, 2u); // which is no more than it may be: this side stays
    EXPECT_EQ(small.rgba, (std::vector<uint8_t>{1, 10, 20, 40, 8, 7, 7, 7, 5, 20, 20, 80, 8, 7, 7, 7}));
    EXPECT_EQ(shrunkTo(1, image, false).rgba, (std::vector<uint8_t>{6, 11, 14, 34})); // 5.5, 11, 13.5, 33.5
}

TEST(BoxFilter, PixelsAtABorderGiveBothTheirShare) {
    Sky sky;
    sky.width = 1;
    sky.height = 5;
    for (const float value : {10.0f, 20.0f, 30.0f, 40.0f, 50.0f})
        sky.pixels.emplace_back(value, 2 * value, 0.0f);
    shrinkTo(3, sky); // 5/3 pixels each
    ASSERT_EQ(sky.width, 1u);
    ASSERT_EQ(sky.height, 3u);
    ASSERT_EQ(sky.pixels.size(), 3u);
    const float means[] = {(10 + 20 * 2 / 3.0f) * 0.6f, 30.0f, (40 * 2 / 3.0f + 50) * 0.6f};
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(sky.pixels[i].x, means[i], 1e-4f);
        EXPECT_NEAR(sky.pixels[i].y, 2 * means[i], 1e-4f);
    }
}

TEST(BoxFilter, ColoursAreAveragedAsLightAndAlphaAsItIs) {
    const Image image = imageOf(2, 1, {{0, 255, 128, 0}, {255, 255, 128, 255}});
    const Image light = shrunkTo(1, image, true), raw = shrunkTo(1, image, false);
    EXPECT_EQ(light.rgba, (std::vector<uint8_t>{srgbByte(0.5f), 255, 128, 128}));
    EXPECT_EQ(raw.rgba, (std::vector<uint8_t>{128, 255, 128, 128}));
}

// The sum of all pixels stays, whatever the sizes are, and so does a picture that is small enough.
TEST(BoxFilter, NoLightIsLostOrMade) {
    constexpr uint32_t kWidth = 97, kHeight = 61;
    Sky whole;
    whole.width = kWidth;
    whole.height = kHeight;
    for (uint32_t i = 0; i < kWidth * kHeight; ++i)
        whole.pixels.emplace_back(static_cast<float>(i * 7919 % 101), 1.0f, static_cast<float>(i % kWidth));
    const auto mean = [](const Sky& sky) {
        glm::dvec3 sum(0.0);
        for (const glm::vec3& pixel : sky.pixels)
            sum += glm::dvec3(pixel);
        return sum / double(sky.pixels.size());
    };
    for (const uint32_t most : {96u, 64u, 60u, 31u, 7u, 1u}) {
        Sky small = whole;
        shrinkTo(most, small);
        EXPECT_EQ(small.width, most);
        EXPECT_EQ(small.height, std::min(most, kHeight));
        for (glm::length_t c = 0; c < 3; ++c)
            EXPECT_NEAR(mean(small)[c], mean(whole)[c], 1e-4 * mean(whole)[c]) << most;
    }
    Sky same = whole;
    shrinkTo(kWidth, same);
    EXPECT_EQ(same.pixels, whole.pixels);
}

TEST(BoxFilter, AWarningNamesTheImageAndBothSizes) {
    Scene scene;
    scene.images.resize(2);
    scene.images[1].name = "bricks";
    EXPECT_EQ(imageName(scene, 0), "image 0");
    EXPECT_EQ(imageName(scene, 1), "image 1 'bricks'");
    EXPECT_EQ(
        tooLarge(20000, 2, 16384),
        "has 20000 x 2 pixels, more along a side than the 16384 that this device takes: it is made smaller "
        "for it");
}

} // namespace
} // namespace relume
