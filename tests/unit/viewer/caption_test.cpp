// This tests captions: where they are, that they can be read on anything, and that nothing else of the
// picture changes.
#include "renderer/caption.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

FloatImage flat(uint32_t width, uint32_t height, float grey) {
    FloatImage image{width, height, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        image.add(channel).assign(size_t{width} * height, grey);
    return image;
}

} // namespace

TEST(Caption, ChangesItsCornerOnlyAndIsReadableOnAnything) {
    const std::vector<std::string> lines = {"room, pure", "4 passes"};
    for (const float grey : {0.0f, 0.2f, 1.0f}) {
        FloatImage image = flat(320, 180, grey);
        drawCaption(image, lines);
        const CaptionBox box = captionBox(320, 180, lines);
        EXPECT_EQ(box.x, 0u);
        EXPECT_EQ(box.y + box.height, 180u);
        EXPECT_LT(box.width, 160u);
        EXPECT_LT(box.height, 40u);
        uint32_t letters = 0;
        for (uint32_t y = 0; y < 180; ++y) {
            for (uint32_t x = 0; x < 320; ++x) {
                const float value = image.planes[0][size_t{320} * y + x];
                const bool inside = x < box.width && y >= box.y;
                if (!inside) {
                    ASSERT_EQ(value, grey) << x << " " << y;
                } else if (value == 1.0f) {
                    ++letters;
                } else {
                    ASSERT_LE(value, 0.15f) << x << " " << y;
                }
            }
        }
        // These are strokes of 18 letters, 5 to 25 pixels each.
        EXPECT_GT(letters, 80u);
        EXPECT_LT(letters, 500u);
    }
}

TEST(Caption, GrowsWithThePicture) {
    const std::vector<std::string> lines = {"room"};
    const CaptionBox small = captionBox(640, 360, lines), large = captionBox(1920, 1080, lines);
    EXPECT_EQ(large.width, 4 * small.width);
    EXPECT_EQ(large.height, 4 * small.height);
}

// Names of scenes may be long, or in letters that the font does not have.
TEST(Caption, IsCutOffWhereItDoesNotFit) {
    FloatImage image = flat(24, 8, 0.5f);
    drawCaption(image, {std::string(200, 'W'), "\xc3\xa9\x01\x7f", "last"});
    EXPECT_EQ(captionBox(24, 8, {std::string(200, 'W'), "last"}).width, 24u);
    EXPECT_EQ(std::count(image.planes[0].begin(), image.planes[0].end(), 0.5f), 0);
}

TEST(Caption, WithoutLinesNothingChanges) {
    FloatImage image = flat(64, 32, 0.5f);
    drawCaption(image, {});
    EXPECT_EQ(std::count(image.planes[0].begin(), image.planes[0].end(), 0.5f), 64 * 32);
}

} // namespace relume
