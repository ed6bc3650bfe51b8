#include "assets/images/ktx2.h"

#include "assets/base/error.h"
#include "assets/images/image_file.h"
#include "assets/images/shared_exponent.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <half.h>

#include <cmath>
#include <fstream>
#include <random>

namespace relume {
namespace {

// Has magnitudes from deep shadow to the sun's disc.
FloatImage coloredNoise(uint32_t width, uint32_t height) {
    FloatImage image{width, height, {}, {}, {}};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> exponent(-12.0f, 14.0f);
    for (const char* channel : {"R", "G", "B", "coverage"})
        for (float& value : image.add(channel))
            value = std::exp2(exponent(random));
    image.planes[0][0] = image.planes[1][0] = image.planes[2][0] = 0.0f;
    return image;
}

uint32_t word(const std::string& bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i)
        value |= uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return value;
}

constexpr uint64_t kEnough = 1 << 20; // pixels

TEST(Ktx2, HalfFloatsComeBackAsHalvesWithAndWithoutZstandard) {
    const FloatImage image = coloredNoise(19, 13);
    for (const bool zstd : {false, true}) {
        const std::string bytes = encodeKtx2(image, {.zstd = zstd}, "a");
        const FloatImage back = decodeKtx2(bytes, "a", kEnough);
        ASSERT_EQ(back.width, 19u);
        ASSERT_EQ(back.height, 13u);
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < image.planes[c].size(); ++i)
                ASSERT_EQ(back.planes[c][i], float(half(image.planes[c][i])));
    }
}

// The header of a 3D texture says so, and its texels are those of the picture that has its slices below each
// other.
TEST(Ktx2, SlicesOfA3dTextureLieOneBeneathAnother) {
    const FloatImage image = coloredNoise(5, 12);
    const std::string flat = encodeKtx2(image, {.zstd = false}, "a");
    const std::string solid = encodeKtx2(image, {.zstd = false, .depth = 3}, "a");
    EXPECT_EQ(word(flat, 24), 12u);
    EXPECT_EQ(word(flat, 28), 0u);
    EXPECT_EQ(word(solid, 20), 5u);
    EXPECT_EQ(word(solid, 24), 4u);
    EXPECT_EQ(word(solid, 28), 3u);
    constexpr size_t kTexels = 5 * 12 * 8;
    EXPECT_EQ(solid.substr(solid.size() - kTexels), flat.substr(flat.size() - kTexels));
    EXPECT_THROW((void)decodeKtx2(solid, "a", kEnough), std::runtime_error) << "no picture is made of it";
}

TEST(Ktx2, SharedExponentsAreOffByHalfAStepOfTheBrightestChannel) {
    const FloatImage image = coloredNoise(31, 17);
    const FloatImage back =
        decodeKtx2(encodeKtx2(image, {.format = Ktx2Format::SharedExponent}, "a"), "a", kEnough);
    for (size_t i = 0; i < image.planes[0].size(); ++i) {
        const float brightest = std::max({image.planes[0][i], image.planes[1][i], image.planes[2][i]});
        for (size_t c = 0; c < 3; ++c)
            ASSERT_LE(std::abs(back.planes[c][i] - image.planes[c][i]), brightest / 512.0f + 0x1p-25f);
    }
}

TEST(Ktx2, PacksSharedExponentsAsOpenGlDoes) {
    EXPECT_EQ(packSharedExponent(glm::vec3(0.0f)), 0u);
    EXPECT_EQ(unpackSharedExponent(packSharedExponent({1.0f, 0.5f, 0.25f})), glm::vec3(1.0f, 0.5f, 0.25f));
    // 1 has the mantissa 256 at an exponent of 16: 256 / 512 x 2^(16 - 15).
    EXPECT_EQ(packSharedExponent({1.0f, 0.0f, 0.0f}), 16u << 27 | 256u);
    EXPECT_EQ(unpackSharedExponent(packSharedExponent(glm::vec3(kMostSharedExponent))),
              glm::vec3(kMostSharedExponent));
    // A mantissa of 511.9 rounds up to 512, for which the next exponent has room.
    EXPECT_EQ(unpackSharedExponent(packSharedExponent({511.9f / 512.0f, 0.0f, 0.0f})).r, 1.0f);
}

TEST(Ktx2, TellsItsLayoutAsTheSpecificationHasIt) {
    const FloatImage image = coloredNoise(6, 4);
    const std::string plain = encodeKtx2(image, {.zstd = false}, "a");
    EXPECT_EQ(plain.substr(1, 6), "KTX 20");
    EXPECT_EQ(word(plain, 12), 97u); // vkFormat
    EXPECT_EQ(word(plain, 16), 2u);  // typeSize
    EXPECT_EQ(word(plain, 20), 6u);
    EXPECT_EQ(word(plain, 24), 4u);
    EXPECT_EQ(word(plain, 36), 1u); // faces
    EXPECT_EQ(word(plain, 40), 1u); // levels
    EXPECT_EQ(word(plain, 44), 0u); // supercompression
    const uint32_t descriptor = word(plain, 48), level = word(plain, 80);
    EXPECT_EQ(descriptor, 104u);
    EXPECT_EQ(word(plain, descriptor), word(plain, 52));
    EXPECT_EQ(word(plain, descriptor + 20), 8u); // bytes of a texel
    EXPECT_EQ(level % 8, 0u);
    EXPECT_EQ(word(plain, 88), 6u * 4 * 8);
    EXPECT_EQ(plain.size(), level + 6u * 4 * 8);
    EXPECT_NE(plain.find(std::string("KTXorientation\0rd\0", 18)), std::string::npos);
    EXPECT_EQ(word(encodeKtx2(image, {}, "a"), 44), 2u);
}

TEST(Ktx2, IsReadAsAnImageFile) {
    const TemporaryFolder folder;
    const FloatImage image = coloredNoise(8, 8);
    std::ofstream(folder.path("a.ktx2"), std::ios::binary) << encodeKtx2(image, {}, "a");
    EXPECT_EQ(readImage(folder.path("a.ktx2")).planes[1][5], float(half(image.planes[1][5])));
    EXPECT_THROW(readImage(folder.path("a.ktx2"), 63), Error);
}

TEST(Ktx2, DamagedFilesAreToldAndNeverReadBeyondTheirEnd) {
    const FloatImage image = coloredNoise(16, 16);
    std::mt19937 random(3);
    size_t refused = 0;
    for (const bool zstd : {false, true}) {
        const std::string whole = encodeKtx2(image, {.zstd = zstd}, "a");
        for (int round = 0; round < 1000; ++round) {
            std::string bytes = whole;
            if (round % 2 == 0) bytes.resize(random() % bytes.size());
            for (int k = 0; k < 3 && !bytes.empty(); ++k)
                bytes[random() % std::min<size_t>(bytes.size(), 120)] = static_cast<char>(random());
            try {
                decodeKtx2(bytes, "a", kEnough);
            } catch (const std::exception&) {
                ++refused;
            }
        }
    }
    EXPECT_GT(refused, 1000u);
}

TEST(Ktx2, CutsWhatIsBeyondItsRangeAndRefusesImagesWithoutColour) {
    FloatImage image = coloredNoise(2, 2);
    image.planes[0][1] = 1e6f;
    EXPECT_EQ(decodeKtx2(encodeKtx2(image, {}, "a"), "a", kEnough).planes[0][1], 65504.0f);
    EXPECT_EQ(
        decodeKtx2(encodeKtx2(image, {.format = Ktx2Format::SharedExponent}, "a"), "a", kEnough).planes[0][1],
        kMostSharedExponent);
    FloatImage grey{2, 2, {}, {}, {}};
    grey.add("Y");
    EXPECT_THROW(encodeKtx2(grey, {}, "a"), Error);
}

} // namespace
} // namespace relume
