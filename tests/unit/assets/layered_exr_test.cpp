#include "assets/images/layered_exr.h"

#include "assets/base/error.h"
#include "assets/images/image_file.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <ImfCompression.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <utility>

namespace relume {
namespace {

FloatImage colors(uint32_t width, uint32_t height, float value) {
    FloatImage image{width, height, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        for (float& texel : image.add(channel))
            texel = value += 0.125f;
    return image;
}

LayeredImage threeLayers() {
    LayeredImage image;
    image.composite = colors(7, 5, 1.0f);
    image.composite.add("coverage").assign(35, 1.0f);
    image.composite.attributes["relume:scene"] = "room.glb";
    const auto add = [&](const char* name, float value, const glm::vec3& weight) {
        image.layers.push_back({name, weight, {{layer_attribute::kType, "point"}}, colors(7, 5, value)});
    };
    add("Lamp", 2.0f, {40, 20.5f, 0.1f});
    add("composite", 3.0f, {0, 0, 0});
    add("Fenster / Glüh", 4.0f, {1, 1, 1});
    image.layers[0].attributes[layer_attribute::kUnit] = "cd";
    return image;
}

class LayeredExrTest : public testing::Test {
protected:
    std::string at(const std::string& name) const { return folder_.path(name); }
    static std::string errorOf(const std::function<void()>& action) {
        try {
            action();
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    }
    void store(const std::string& name, const std::string& bytes) const {
        std::ofstream(at(name), std::ios::binary) << bytes;
    }

    const TemporaryFolder folder_;
};

TEST_F(LayeredExrTest, ReturnsWhatWasWritten) {
    const LayeredImage image = threeLayers();
    writeLayeredExr(at("a.exr"), image);
    const LayeredImage read = readLayeredExr(at("a.exr"));
    EXPECT_EQ(read.composite.channels, image.composite.channels);
    EXPECT_EQ(read.composite.planes, image.composite.planes);
    EXPECT_EQ(read.composite.attributes, image.composite.attributes);
    ASSERT_EQ(read.layers.size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(read.layers[i].name, image.layers[i].name);
        EXPECT_EQ(read.layers[i].weight, image.layers[i].weight);
        EXPECT_EQ(read.layers[i].attributes, image.layers[i].attributes);
        EXPECT_EQ(read.layers[i].image.planes, image.layers[i].image.planes);
        EXPECT_EQ(read.layers[i].image.channels, (std::vector<std::string>{"R", "G", "B"}));
    }
    writeLayeredExr(at("b.exr"), read);
    EXPECT_EQ(bytesOf(at("a.exr")), bytesOf(at("b.exr")));
    EXPECT_EQ(folder_.files().size(), 2u);
}

TEST_F(LayeredExrTest, EveryPartIsCompressedAsAskedFor) {
    const LayeredImage image = threeLayers();
    for (const auto& [compression, wanted] : {std::pair(ExrCompression::Off, Imf::NO_COMPRESSION),
                                              {ExrCompression::Rle, Imf::RLE_COMPRESSION},
                                              {ExrCompression::Zips, Imf::ZIPS_COMPRESSION},
                                              {ExrCompression::Zip, Imf::ZIP_COMPRESSION},
                                              {ExrCompression::Piz, Imf::PIZ_COMPRESSION}}) {
        writeLayeredExr(at("a.exr"), image, ExrType::Float, compression);
        const LayeredImage read = readLayeredExr(at("a.exr"));
        EXPECT_EQ(read.composite.planes, image.composite.planes);
        const Imf::MultiPartInputFile file(at("a.exr").c_str());
        ASSERT_EQ(file.parts(), 4);
        for (int p = 0; p < 4; ++p) {
            EXPECT_EQ(file.header(p).compression(), wanted);
            if (p == 0) continue;
            const size_t layer = size_t(p) - 1;
            EXPECT_EQ(read.layers[layer].image.planes, image.layers[layer].image.planes);
        }
    }
}

TEST_F(LayeredExrTest, ReadersOfOneImageGetTheComposite) {
    const LayeredImage image = threeLayers();
    writeLayeredExr(at("a.exr"), image);
    const FloatImage read = readImage(at("a.exr"));
    EXPECT_EQ(read.channels, image.composite.channels);
    EXPECT_EQ(read.planes, image.composite.planes);
    writeImage(at("copy.exr"), read);
    EXPECT_EQ(readImage(at("copy.exr")).planes, image.composite.planes);
}

TEST_F(LayeredExrTest, OtherProgramsFindThePartsByName) {
    writeLayeredExr(at("a.exr"), threeLayers());
    const Imf::MultiPartInputFile file(at("a.exr").c_str());
    ASSERT_EQ(file.parts(), 4);
    const char* names[] = {"composite", "Lamp", "composite 2", "Fenster / Glüh"};
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(file.header(i).name(), names[i]);
}

TEST_F(LayeredExrTest, HalvesAreAsNearAsHalvesAre) {
    const LayeredImage image = threeLayers();
    writeLayeredExr(at("a.exr"), image, ExrType::Half);
    const LayeredImage read = readLayeredExr(at("a.exr"));
    for (size_t i = 0; i < 35; ++i)
        EXPECT_NEAR(read.layers[0].image.planes[1][i], image.layers[0].image.planes[1][i],
                    image.layers[0].image.planes[1][i] / 2048); // 11 bits
    EXPECT_EQ(read.layers[0].weight, image.layers[0].weight);
}

TEST_F(LayeredExrTest, ASceneWithoutLightsHasNoLayers) {
    LayeredImage image = threeLayers();
    image.layers.clear();
    writeLayeredExr(at("a.exr"), image);
    EXPECT_TRUE(readLayeredExr(at("a.exr")).layers.empty());
}

TEST_F(LayeredExrTest, WhatIsWrongIsNamed) {
    const std::string path = at("a.exr");
    EXPECT_EQ(errorOf([&] { readLayeredExr(path); }), path + ": no such file: check the name");
    writeImage(path, colors(4, 4, 1));
    EXPECT_EQ(errorOf([&] { readLayeredExr(path); }),
              path + ": has no layers: name a file that 'relume bake --layers' wrote");
    LayeredImage image = threeLayers();
    image.layers[1].weight.g = std::numeric_limits<float>::infinity();
    writeLayeredExr(path, image);
    EXPECT_EQ(errorOf([&] { readLayeredExr(path); }),
              path + ": the weight of its part 'composite' is not finite: bake it again");
    image = threeLayers();
    image.layers[2].name = "Lamp";
    writeLayeredExr(path, image);
    EXPECT_EQ(errorOf([&] { readLayeredExr(path); }), path + ": has two layers named 'Lamp': bake it again");
    image = threeLayers();
    image.layers[2].image.channels[1] = "green";
    writeLayeredExr(path, image);
    EXPECT_EQ(errorOf([&] { readLayeredExr(path); }),
              path + ": its part 'Fenster / Glüh' has no channel G: bake it again");
    EXPECT_EQ(errorOf([&] { writeLayeredExr(at("a.png"), image); }),
              at("a.png") + ": layers are kept in OpenEXR only: give a name in .exr");
    EXPECT_NE(errorOf([&] { writeLayeredExr(at("none/a.exr"), image); }).find("none"), std::string::npos);
}

/// Broken files are errors of one line, never a crash or a request for more memory than there is.
TEST_F(LayeredExrTest, SurvivesBrokenFiles) {
    writeLayeredExr(at("a.exr"), threeLayers());
    const std::string whole = bytesOf(at("a.exr"));
    std::mt19937 random(3);
    for (int i = 0; i < 400; ++i) {
        std::string bytes = whole;
        if (i % 2 == 0) bytes.resize(random() % whole.size());
        for (uint32_t n = random() % 4; n > 0 && !bytes.empty(); --n)
            bytes[random() % bytes.size()] = char(random());
        store("b.exr", bytes);
        const std::string message = errorOf([&] { readLayeredExr(at("b.exr")); });
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        if (message != "no error") {
            EXPECT_EQ(message.find(at("b.exr")), 0u) << message;
        }
        if (i % 2 == 0 && bytes.size() < whole.size()) {
            EXPECT_NE(message, "no error") << bytes.size();
        }
    }
}

} // namespace
} // namespace relume
