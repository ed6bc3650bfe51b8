#include "assets/images/png_check.h"

#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/log_capture.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

using Bytes = std::vector<uint8_t>;

std::string problemOf(const Bytes& png) {
    return findPngDamage({reinterpret_cast<const char*>(png.data()), png.size()}).problem;
}

/// Returns a PNG with one bit of the checksum of IDAT, or of IHDR, turned over.
Bytes withWrongChecksum(size_t at = 41 + 17 + 2) {
    Bytes png = test::kTwoPixels;
    png[at] ^= 1;
    return png;
}

Bytes withoutEnd(size_t missing = 12) {
    return {test::kTwoPixels.begin(), test::kTwoPixels.end() - static_cast<std::ptrdiff_t>(missing)};
}

TEST(PngCheck, FindsWrongChecksumsAndMissingEnds) {
    EXPECT_EQ(problemOf(test::kTwoPixels), "");
    Bytes longer = test::kTwoPixels;
    longer.push_back(7); // what follows the end is nobody's
    EXPECT_EQ(problemOf(longer), "");
    EXPECT_EQ(problemOf(withWrongChecksum()), "its chunk 'IDAT' has a wrong checksum");
    EXPECT_EQ(problemOf(withWrongChecksum(30)), "its chunk 'IHDR' has a wrong checksum");
    for (size_t missing = 1; missing <= 12; ++missing)
        EXPECT_EQ(problemOf(withoutEnd(missing)), "it ends before its last chunk, IEND") << missing;
    EXPECT_EQ(problemOf({0xff, 0xd8, 0xff}), "");
    EXPECT_EQ(problemOf({}), "");
}

TEST(PngCheck, EveryFlippedBitOfAChunkIsFound) {
    for (size_t at = 8; at < test::kTwoPixels.size(); ++at)
        for (int bit = 0; bit < 8; ++bit) {
            Bytes png = test::kTwoPixels;
            png[at] = static_cast<uint8_t>(png[at] ^ 1 << bit);
            EXPECT_NE(problemOf(png), "") << at;
        }
}

Scene loadWithImage(const Bytes& png, bool beside) {
    test::GlbBuilder b = test::squareScene();
    if (beside)
        b.json["images"] = {
            {{"uri", std::filesystem::path(test::writeBytes("damaged.png", png)).filename().string()}}};
    else
        b.json["images"] = {{{"bufferView", b.view(png)}, {"mimeType", "image/png"}, {"name", "Wood"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    return loadGltf(b.write("scene.glb"));
}

TEST(PngCheck, DamagedImagesOfScenesWarnAndAreUsed) {
    for (const bool beside : {false, true}) {
        const std::string name = beside ? "image file 'damaged.png'" : "image 0 'Wood'";
        EXPECT_TRUE(loadWithImage(test::kTwoPixels, beside).warnings.empty());
        for (const Bytes& png : {withWrongChecksum(), withoutEnd(), withoutEnd(3)}) {
            const Scene scene = loadWithImage(png, beside);
            ASSERT_EQ(scene.warnings.size(), 1u);
            EXPECT_NE(scene.warnings[0].find(name + ": is damaged (it"), std::string::npos)
                << scene.warnings[0];
            ASSERT_EQ(scene.images.size(), 1u);
            EXPECT_EQ(scene.images[0].width, 2u);
            EXPECT_EQ(scene.images[0].rgba[0], 255);
        }
    }
}

TEST(PngCheck, DamagedPicturesThatAreReadWarn) {
    const TemporaryFolder folder;
    for (const Bytes& png : {test::kTwoPixels, withWrongChecksum(), withoutEnd()}) {
        const std::string path = folder.path("picture.png");
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
        const LogCapture log;
        EXPECT_EQ(readImage(path).width, 2u);
        EXPECT_EQ(contains(log.text(), path + ": it"), png != test::kTwoPixels) << log.text();
    }
}

} // namespace
} // namespace relume
