#include "assets/base/error.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

namespace relume {
namespace {

std::string bytesOf(const std::vector<int>& values) {
    return {values.begin(), values.end()};
}

class RadianceHdr : public testing::Test {
protected:
    FloatImage read(const std::string& bytes) const {
        std::ofstream(path_, std::ios::binary) << bytes;
        return readImage(path_);
    }
    std::string errorOf(const std::string& bytes) const {
        try {
            read(bytes);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }
    static std::string header(const std::string& size) {
        return "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n" + size + "\n";
    }

    const TemporaryFolder folder_;
    const std::string path_ = folder_.path("sky.HDR");
};

TEST_F(RadianceHdr, DecodesPixelByPixel) {
    // 128 with an exponent of 129 is 128 / 256 x 2; with an exponent of 0 all is black.
    const FloatImage image = read(header("-Y 2 +X 2") + bytesOf({128, 64, 0, 129, 255, 1, 2, 136, //
                                                                 9, 9, 9, 0, 128, 128, 128, 1}));
    ASSERT_EQ(image.width, 2u);
    ASSERT_EQ(image.height, 2u);
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
    const float tiny = 128.0f / 256.0f / 0x1p127f;
    EXPECT_EQ(image.planes[0], (std::vector<float>{1.0f, 255.0f, 0.0f, tiny}));
    EXPECT_EQ(image.planes[1], (std::vector<float>{0.5f, 1.0f, 0.0f, tiny}));
    EXPECT_EQ(image.planes[2], (std::vector<float>{0.0f, 2.0f, 0.0f, tiny}));
}

TEST_F(RadianceHdr, DecodesRunsOfPixels) {
    // There are 1 + 2 + 1 x 256 pixels: later counts are higher digits.
    const FloatImage image =
        read(header("-Y 1 +X 260") + bytesOf({128, 0, 0, 129, 1, 1, 1, 2, 1, 1, 1, 1, 0, 128, 0, 129}));
    for (size_t i = 0; i < 260; ++i) {
        EXPECT_EQ(image.planes[0][i], i < 259 ? 1.0f : 0.0f) << i;
        EXPECT_EQ(image.planes[1][i], i < 259 ? 0.0f : 1.0f) << i;
    }
}

/// Returns ten pixels channel by channel: a run, or single values.
std::string planarRow() {
    return bytesOf({2,       2,   0,       10, 128 + 10, 128, 3, 0, 1, 2, 128 + 7, 7,
                    10,      0,   1,       2,  3,        4,   5, 6, 7, 8, 9, //
                    128 + 4, 136, 128 + 6, 137});
}

TEST_F(RadianceHdr, DecodesRunsOfChannels) {
    const FloatImage image = read(header("-Y 2 +X 10") + planarRow() + planarRow());
    for (size_t i = 0; i < 20; ++i) {
        const float unit = i % 10 < 4 ? 1.0f : 2.0f;
        EXPECT_EQ(image.planes[0][i], 128.0f * unit) << i;
        EXPECT_EQ(image.planes[1][i], float(i % 10 < 3 ? i % 10 : 7) * unit) << i;
        EXPECT_EQ(image.planes[2][i], float(i % 10) * unit) << i;
    }
}

TEST_F(RadianceHdr, EveryTruncationIsAnError) {
    for (const std::string& whole :
         {header("-Y 2 +X 10") + planarRow() + planarRow(),
          header("-Y 1 +X 260") + bytesOf({128, 0, 0, 129, 1, 1, 1, 2, 1, 1, 1, 1, 0, 128, 0, 129})})
        for (size_t size = 0; size < whole.size(); ++size)
            EXPECT_EQ(errorOf(whole.substr(0, size)).rfind(path_ + ": cannot be read as an image (", 0), 0u)
                << size;
}

TEST_F(RadianceHdr, NamesWhatIsWrong) {
    const auto says = [&](const std::string& bytes, const std::string& part) {
        const std::string error = errorOf(bytes);
        EXPECT_NE(error.find(part), std::string::npos) << error;
    };
    says("\x89PNG\n", "it is no Radiance picture");
    says("#?RGBE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n0000", "its format is not 32-bit_rle_rgbe");
    for (const char* size : {"+Y 1 +X 1", "-Y -1 +X 1", "-Y 0 +X 1", "-Y 1", "-Y 99999999999 +X 1", "1 1"})
        says(header(size) + "0000", "its size is not told as '-Y height +X width'");
    says(header("-Y 60000 +X 60000") + "0000", "its header claims 60000 x 60000");
    says(header("-Y 1 +X 1") + bytesOf({1, 1, 1, 1}), "a run is damaged"); // of nothing before it
    std::string zero = planarRow(), wide = planarRow();
    zero[4] = 0;
    wide[4] = char(128 + 11);
    says(header("-Y 1 +X 10") + zero, "a run is damaged");
    says(header("-Y 1 +X 10") + wide, "a run is damaged");
}

TEST_F(RadianceHdr, IsNeverWritten) {
    FloatImage image{1, 1, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        image.add(channel);
    EXPECT_THROW(writeImage(path_, image), Error);
    EXPECT_THROW(checkWritable(path_), Error);
    EXPECT_TRUE(folder_.files().empty());
}

TEST_F(RadianceHdr, LargerPicturesThanWantedAreErrorsInAllFormats) {
    FloatImage image{4, 3, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        image.add(channel);
    read(header("-Y 3 +X 4") + std::string(48, '\2'));
    writeImage(folder_.path("a.exr"), image);
    writeImage(folder_.path("a.png"), image);
    for (const std::string& path : {path_, folder_.path("a.exr"), folder_.path("a.png")}) {
        EXPECT_EQ(readImage(path, 12).width, 4u) << path;
        try {
            readImage(path, 11);
            ADD_FAILURE() << path;
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).rfind(path + ": has 4 x 3 pixels, more than ", 0), 0u)
                << error.what();
        }
    }
}

} // namespace
} // namespace relume
