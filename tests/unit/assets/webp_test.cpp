// WebP pictures: what is right decodes to its pixels, what is damaged to nothing.
#include "assets/decode/webp.h"
#include "tests/unit/webp_pictures.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

using Bytes = std::vector<uint8_t>;

TEST(Webp, DecodesWithAndWithoutLoss) {
    EXPECT_EQ(decodeWebp(test::kTwoPixelsWebp), (Bytes{255, 0, 0, 255, 0, 128, 255, 64}));
    const auto size = webpSize(test::kLossyWebp);
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, 24u);
    EXPECT_EQ(size->height, 24u);
    const auto pixels = decodeWebp(test::kLossyWebp);
    ASSERT_TRUE(pixels);
    ASSERT_EQ(pixels->size(), 4u * 24 * 24);
    // The picture is x * 10, y * 10 in red and green; its alpha is 255 left of x = 12 and 100 + x y / 5 right
    // of it.
    const uint8_t* middle = pixels->data() + size_t{4} * (24 * 12 + 6);
    EXPECT_NEAR(middle[0], 60, 40);
    EXPECT_NEAR(middle[1], 120, 40);
    EXPECT_EQ(middle[3], 255);
    EXPECT_EQ((*pixels)[size_t{4} * (24 * 10 + 20) + 3], 140);
}

TEST(Webp, WhatIsNoneOrEndsEarlyIsNothing) {
    for (const Bytes& none :
         {Bytes{}, Bytes{'R', 'I', 'F', 'F', 4, 0, 0, 0, 'W', 'A', 'V', 'E'}, Bytes(40, 0)}) {
        EXPECT_FALSE(isWebp(none));
        EXPECT_FALSE(webpSize(none));
        EXPECT_FALSE(decodeWebp(none));
    }
    EXPECT_TRUE(isWebp(test::kLossyWebp));
    for (const Bytes& whole : {test::kTwoPixelsWebp, test::kLosslessWebp, test::kLossyWebp})
        for (size_t size = 0; size + 2 < whole.size(); ++size)
            EXPECT_FALSE(decodeWebp(std::span(whole).first(size))) << size << " of " << whole.size();
}

/// Each stream lies in memory of just its size, so that a sanitizer sees a read past its end.
TEST(Webp, AThousandMutatedStreamsNeverCrash) {
    std::mt19937 random(7);
    int decoded = 0, refused = 0;
    for (int round = 0; round < 1000; ++round) {
        const Bytes& whole = round % 2 == 0 ? test::kLossyWebp : test::kLosslessWebp;
        Bytes bytes = whole;
        for (uint32_t changes = 1 + random() % 4; changes > 0; --changes)
            bytes[12 + random() % (bytes.size() - 12)] = static_cast<uint8_t>(random());
        bytes.resize(bytes.size() - random() % 3);
        bytes.shrink_to_fit();
        const auto size = webpSize(bytes);
        // A header may tell any size; the caller refuses what is too large, as this does.
        if (size && uint64_t{size->width} * size->height > 1'000'000) continue;
        const auto pixels = decodeWebp(bytes);
        (pixels ? decoded : refused)++;
        if (pixels) {
            EXPECT_EQ(pixels->size(), size_t{4} * size->width * size->height);
        }
    }
    EXPECT_GT(decoded, 50);
    EXPECT_GT(refused, 50);
}

} // namespace
} // namespace relume
