// This tests lightmaps of several pages as files.
#include "assets/images/paged_image.h"

#include "assets/base/error.h"
#include "tests/log_capture.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kEdge = 8;

/// Makes the sheet of so many pages; each texel has its own value, and none where there is no page.
FloatImage sheet(uint32_t count, float factor = 1.0f) {
    const LightmapPages pages{count};
    FloatImage image;
    image.width = image.height = pages.sheetOf(kEdge);
    for (const char* channel : {"R", "G", "B", "coverage"})
        image.add(channel);
    for (uint32_t page = 0; page < count; ++page)
        for (uint32_t y = 0; y < kEdge; ++y)
            for (uint32_t x = 0; x < kEdge; ++x) {
                const glm::uvec2 at = pages.cellOf(page) * kEdge + glm::uvec2(x, y);
                for (size_t c = 0; c < 4; ++c)
                    image.planes[c][size_t{at.y} * image.width + at.x] =
                        factor * float(1000 * page + 100 * c + kEdge * y + x);
            }
    image.attributes["relume:scene"] = "room.glb";
    noteLightmapPages(image, pages);
    return image;
}

LayeredImage layered(uint32_t count) {
    LayeredImage image{sheet(count), {}};
    for (const char* name : {"Lamp", "Sky"}) {
        LayeredImage::Layer layer{name, glm::vec3(2.0f), {{"relume:type", "point"}}, sheet(count, 0.5f)};
        layer.image.attributes.clear();
        image.layers.push_back(layer);
    }
    return image;
}

class PagedImage : public testing::Test {
protected:
    std::string path(const std::string& name) const { return folder_.path(name); }
    std::string errorOf(const std::string& name) const {
        try {
            readLightmapFile(path(name));
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    }
    void expectError(const std::string& name, const std::string& part) const {
        const std::string error = errorOf(name);
        EXPECT_NE(error.find(part), std::string::npos) << error;
        EXPECT_EQ(error.find('\n'), std::string::npos);
    }
    TemporaryFolder folder_;
};

TEST_F(PagedImage, NumbersStandBeforeTheEnding) {
    EXPECT_EQ(pagePath("a.b/room.exr", 3), "a.b/room.3.exr");
    EXPECT_EQ(pagePath("a.b/room", 0), "a.b/room.0");
    EXPECT_EQ(lightmapFiles("room.exr", {1}), (std::vector<std::string>{"room.exr"}));
    EXPECT_EQ(lightmapFiles("room.png", {2}), (std::vector<std::string>{"room.0.png", "room.1.png"}));
}

TEST_F(PagedImage, OnePageIsAFileAsEver) {
    const FloatImage image = sheet(1);
    writeLightmap(path("a.exr"), image);
    writeImage(path("b.exr"), image);
    EXPECT_EQ(bytesOf(path("a.exr")), bytesOf(path("b.exr")));
    EXPECT_EQ(readLightmapFile(path("a.exr")).planes, image.planes);
}

TEST_F(PagedImage, WhatAPngCutsOffIsTold) {
    FloatImage image{100, 1, {}, {}, {}};
    for (const char* channel : {"R", "G", "B", "coverage", "stderr"})
        image.add(channel).assign(100, 1.0f);
    image.planes[4][5] = 9.0f; // no light
    EXPECT_EQ(lostInPng("a.png", image), "") << "1 is white";
    std::fill_n(image.planes[1].begin(), 40, 1.5f);
    EXPECT_EQ(lostInPng("a.exr", image), "");
    EXPECT_EQ(lostInPng("a.png", image),
              "a.png: 40 % of its texels are brighter than 1, the most that a .png "
              "holds, and were cut to it: write an .exr, which holds all");
    std::fill_n(image.planes[3].begin(), 20, 0.5f); // filled beside surfaces
    EXPECT_NE(lostInPng("a.png", image).find("25 %"), std::string::npos);
    const LogCapture log;
    writeLightmap(path("a.png"), image);
    EXPECT_NE(log.text().find("a.png: 25 % of its texels"), std::string::npos) << log.text();
    writeLightmapPicture(path("b.png"), image);
    EXPECT_TRUE(fs::exists(path("b.png")));
    EXPECT_EQ(log.text().find("b.png"), std::string::npos) << "nothing is lost beside an .exr";
}

TEST_F(PagedImage, PagesAreReadAsTheyWereWritten) {
    for (const uint32_t count : {2u, 3u, 4u, 7u}) {
        const std::string name = "map" + std::to_string(count) + ".exr";
        const FloatImage image = sheet(count);
        writeLightmap(path(name), image);
        EXPECT_FALSE(fs::exists(path(name)));
        EXPECT_EQ(filesOfLightmap(path(name)).size(), count);
        const FloatImage read = readLightmapFile(path(name));
        EXPECT_EQ(lightmapPagesOf(read).count, count);
        EXPECT_EQ(read.planes, image.planes) << count;
        EXPECT_EQ(read.attributes, image.attributes);
        const FloatImage page = readImageOrPages(pagePath(path(name), 1));
        EXPECT_EQ(page.width, kEdge) << "a page is an image by itself";
        EXPECT_EQ(page.planes[1][9], 1000.0f + 100.0f + 9.0f);
    }
}

TEST_F(PagedImage, LayersAreReadAsTheyWereWritten) {
    const LayeredImage image = layered(3);
    writeLayeredLightmap(path("layers.exr"), image);
    const LayeredImage read = readLayeredLightmap(path("layers.exr"));
    EXPECT_EQ(read.composite.planes, image.composite.planes);
    EXPECT_EQ(read.composite.attributes, image.composite.attributes);
    ASSERT_EQ(read.layers.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(read.layers[i].name, image.layers[i].name);
        EXPECT_EQ(read.layers[i].weight, image.layers[i].weight);
        EXPECT_EQ(read.layers[i].attributes, image.layers[i].attributes);
        EXPECT_EQ(read.layers[i].image.planes, image.layers[i].image.planes);
    }
    // The composite alone serves who knows no layers, page by page.
    EXPECT_EQ(readLightmapFile(path("layers.exr")).planes, image.composite.planes);
}

TEST_F(PagedImage, WhatIsWrongWithPagesIsToldInOneLine) {
    writeLightmap(path("map.exr"), sheet(3));
    expectError("map.1.exr", "is page 1 of a lightmap of 3: name all of them as " + path("map.exr"));

    fs::rename(path("map.2.exr"), path("kept.exr"));
    expectError("map.exr", "map.2.exr: no such file, but");
    fs::copy_file(path("map.1.exr"), path("map.2.exr"));
    expectError("map.exr", "map.2.exr: is page 1 and not 2");

    fs::remove(path("map.2.exr"));
    FloatImage small;
    small.width = small.height = 4;
    for (const char* channel : {"R", "G", "B", "coverage"})
        small.add(channel);
    writeImage(path("map.2.exr"), small);
    expectError("map.exr", "map.2.exr: is no page of a lightmap");
    small.attributes = {{"relume:page", "2"}, {"relume:pages", "3"}, {"relume:lightmap", "0"}};
    writeImage(path("map.2.exr"), small);
    expectError("map.exr", "map.2.exr: has 4 x 4 texels and");

    writeLightmap(path("other.exr"), sheet(3, 2.0f));
    fs::copy_file(path("other.2.exr"), path("map.2.exr"), fs::copy_options::overwrite_existing);
    expectError("map.exr", "map.2.exr: is a page of another lightmap than");

    fs::rename(path("kept.exr"), path("map.2.exr"));
    EXPECT_EQ(errorOf("map.exr"), "none");
    writeImage(path("map.exr"), small);
    expectError("map.exr", "map.exr: is there and so are pages of this name");
    FloatImage plain = small;
    plain.attributes.clear();
    writeImage(path("small2.exr"), plain);
    writeImage(path("small2.0.exr"), plain); // it is an image that is called so
    EXPECT_EQ(errorOf("small2.exr"), "none");
    expectError("missing.exr", "missing.exr: no such file");
    writeLightmap(path("picture.png"), sheet(2));
    expectError("picture.png", "picture.0.png: does not say how many pages");
}

TEST_F(PagedImage, LayersOfAnotherFileAreNotMixedUp) {
    writeLayeredLightmap(path("layers.exr"), layered(2));
    LayeredImage other = layered(2);
    other.layers[0].image.planes[0][3] += 1.0f;
    writeLayeredLightmap(path("other.exr"), other);
    fs::copy_file(path("other.1.exr"), path("layers.1.exr"), fs::copy_options::overwrite_existing);
    EXPECT_THROW(readLayeredLightmap(path("layers.exr")), Error);
}

} // namespace
} // namespace relume
