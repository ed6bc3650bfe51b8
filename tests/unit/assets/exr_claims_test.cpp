// What pictures claim and do not hold costs no memory.
#include "assets/base/error.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/layered_exr.h"
#include "assets/images/sky_picture.h"
#include "tests/exr_claims.h"
#include "tests/message_of.h"
#include "tests/peak_memory.h"
#include "tests/temporary_folder.h"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>

#include <fstream>
#include <functional>
#include <random>

namespace relume {
namespace {

using test::ExrClaims;
using test::raw;
using test::text;

class ClaimsTest : public testing::Test {
protected:
    std::string store(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_.path(name), std::ios::binary) << bytes;
        return folder_.path(name);
    }
    /// Expects that all readers refuse the file with one line that has `part`, and take little memory for
    /// that.
    void expectRefused(const std::string& bytes, const std::string& part) const {
        const std::string path = store("claims.exr", bytes);
        const std::function<void()> readers[] = {[&] { readImage(path); }, [&] { readLayeredExr(path); },
                                                 [&] {
                                                     Sky sky;
                                                     sky.file = path;
                                                     readSkyPicture(sky);
                                                 }};
        for (const auto& reader : readers) {
            std::string message;
            const int64_t grown = test::peakGrowth([&] { message = messageOf(reader); });
            EXPECT_LT(grown, test::kLittleMemory);
            EXPECT_GE(grown, 0);
            message = messageOf(reader); // the other one was in the child
            EXPECT_EQ(message.find(path + ": "), 0u) << message;
            EXPECT_NE(message.find(part), std::string::npos) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        }
    }

    const TemporaryFolder folder_;
};

TEST_F(ClaimsTest, HeadersOfLargePicturesInSmallFiles) {
    expectRefused(ExrClaims{.right = 3, .bottom = 0x3fffffff}.bytes(),
                  "its header claims 4 x 1073741824 pixels");
    expectRefused(ExrClaims{.right = 0x7fffffff, .bottom = 0x7fffffff}.bytes(), "its header claims");
    expectRefused(ExrClaims{.right = 32767, .bottom = 32767}.bytes(std::string(20000, 'x')),
                  "its header claims");
    expectRefused(ExrClaims{.right = 4095, .bottom = 4095, .channels = 3000}.bytes(), "its header claims");
    // The picture is one line, which comes in a piece of 256.
    expectRefused(
        ExrClaims{.right = 999'999, .bottom = 0, .channels = 100, .compression = 9}.bytes("xxxxxxxx"),
        "its header claims pieces of");
    // There is room for what DWA packs best, but not for its table.
    expectRefused(ExrClaims{.right = 0, .bottom = 1'000'000, .compression = 8}.bytes(), "chunks");
}

TEST_F(ClaimsTest, HeadersOfTilesPartsAndDeepPictures) {
    ExrClaims tiles{.right = 2999, .bottom = 2999, .compression = 9};
    tiles.tileWidth = tiles.tileHeight = 1;
    expectRefused(tiles.bytes(std::string(2000, '\0')), "chunks");
    tiles.tileWidth = tiles.tileHeight = 1'000'000;
    expectRefused(tiles.bytes(std::string(2000, '\0')), "pieces of");
    tiles.tileWidth = tiles.tileHeight = 0x7fffffff;
    expectRefused(tiles.bytes(), "tiles of");
    expectRefused(ExrClaims{.version = 2 | 0x800}.bytes(), "deep data");
    const std::string deep = ExrClaims{.type = "deepscanline"}.header();
    expectRefused(raw(20000630) + raw(2 | 0x1000) + deep + '\0', "deep data");

    std::string parts;
    for (int i = 0; i < 200; ++i)
        parts += ExrClaims{.right = 1023, .bottom = 1023, .compression = 9, .type = "scanlineimage"}.header();
    expectRefused(raw(20000630) + raw(2 | 0x1000) + parts + '\0' + std::string(10000, '\0'),
                  "its header claims");
    expectRefused(ExrClaims{.sampling = 2}.bytes(), "subsampled");
}

TEST_F(ClaimsTest, AttributesLargerThanTheFile) {
    const auto with = [](const std::string& kind, int32_t size, const std::string& value) {
        ExrClaims claims;
        claims.more = text("other") + text(kind) + raw(size) + value;
        return claims.bytes();
    };
    expectRefused(with("string", 0x7fffffff, ""), "2147483647 bytes of attribute other");
    expectRefused(with("acme", 0x7fffffff, ""), "2147483647 bytes of attribute other");
    expectRefused(with("string", -5, ""), "-5 bytes of attribute other");
    expectRefused(with("preview", 8, raw(30000) + raw(30000)), "a preview of 30000 x 30000");
    expectRefused(with("stringvector", 4, raw(0x7ffffff0)), "ends too early");
    // OpenEXR goes by its type's size, so that what it reads next is inside of it.
    expectRefused(with("v2f", 24, std::string(24, 'x')), "24 bytes for a value of type v2f");
    expectRefused(with("float", 0, ""), "0 bytes for a value of type float");
    ExrClaims chunks;
    chunks.more = ExrClaims::attribute("chunkCount", "int", raw(0x7fffffff));
    expectRefused(chunks.bytes(), "2147483647 chunks");
}

// Pixels take memory as they come, and here none come.
TEST_F(ClaimsTest, RubbishBehindAHeaderThatFits) {
    std::string rubbish(600'000, '\0');
    std::mt19937 random(1);
    for (char& byte : rubbish)
        byte = static_cast<char>(random());
    const std::string path = store("a.exr", ExrClaims{.right = 4999, .bottom = 4999}.bytes(rubbish));
    EXPECT_LT(test::peakGrowth([&] { messageOf([&] { readImage(path); }); }), test::kLittleMemory);
    EXPECT_NE(messageOf([&] { readImage(path); }).find("cannot be read as an image"), std::string::npos);
    const std::string hdr = store("a.hdr", "#?RADIANCE\n\n-Y 5000 +X 5000\n" + rubbish);
    EXPECT_LT(test::peakGrowth([&] { messageOf([&] { readImage(hdr); }); }), test::kLittleMemory);
    EXPECT_NE(messageOf([&] { readImage(hdr); }).find("cannot be read as an image"), std::string::npos);
    const std::string small = store("b.hdr", "#?RADIANCE\n\n-Y 20000 +X 20000\n");
    EXPECT_NE(messageOf([&] { readImage(small); }).find("claims 20000 x 20000 pixels"), std::string::npos);
}

// The best case of each codec is no lie.
TEST_F(ClaimsTest, PicturesOfOneColourAreReadFromAllCodecs) {
    constexpr int kWidth = 2048, kHeight = 1024;
    const std::vector<half> black(size_t(kWidth) * kHeight);
    for (const bool tiled : {false, true})
        for (int c = 0; c < Imf::NUM_COMPRESSION_METHODS; ++c) {
            Imf::Header header(kWidth, kHeight);
            header.compression() = static_cast<Imf::Compression>(c);
            Imf::FrameBuffer frame;
            for (const char* channel : {"R", "G", "B", "A"}) {
                header.channels().insert(channel, Imf::Channel(Imf::HALF));
                frame.insert(channel, Imf::Slice::Make(Imf::HALF, black.data(), header.dataWindow()));
            }
            const std::string path = folder_.path("black.exr");
            if (tiled) {
                header.setTileDescription(Imf::TileDescription(256, 128, Imf::ONE_LEVEL));
                Imf::TiledOutputFile file(path.c_str(), header);
                file.setFrameBuffer(frame);
                file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
            } else {
                Imf::OutputFile file(path.c_str(), header);
                file.setFrameBuffer(frame);
                file.writePixels(kHeight);
            }
            const FloatImage image = readImage(path);
            EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
            EXPECT_EQ(image.planes[3], std::vector<float>(size_t(kWidth) * kHeight)) << c;
        }
}

} // namespace
} // namespace relume
