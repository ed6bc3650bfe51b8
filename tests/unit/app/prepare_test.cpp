// How large a lightmap is made for a level whose user names no size.
#include "app/edit/prepare.h"

#include "app/offline/bake_options.h"
#include "assets/atlas/unwrap.h"

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace relume {
namespace {

const std::string kRoom = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_small.glb";

PreparedScene fitted(double density, std::vector<uint32_t>& asked, uint32_t allowed) {
    return prepareScene({.path = kRoom,
                         .size = 64,
                         .leastDensity = density,
                         .fitting = [&asked, allowed](const Scene&, LightmapPages pages, uint32_t edge) {
                             EXPECT_EQ(pages.count, 1u);
                             asked.push_back(edge);
                             return std::min(edge, allowed);
                         }});
}

TEST(Prepare, MakesALightmapOfTheDensityThatIsWanted) {
    std::vector<uint32_t> asked;
    EXPECT_EQ(fitted(0, asked, 8192).size, 64u) << "none is wanted";
    const double least = 1.0, most = 32.0;
    uint32_t before = 64;
    for (double density = least; density <= most; density *= 2) {
        const PreparedScene room = fitted(density, asked, 8192);
        EXPECT_GE(room.size, before);
        EXPECT_EQ(room.size & (room.size - 1), 0u) << "a power of two";
        EXPECT_GE(room.size * std::sqrt(0.85 / surfaceArea(room.scene)), density) << "charts cover 85 %";
        before = room.size;
    }
    EXPECT_GT(before, 64u);
    EXPECT_FALSE(asked.empty());
}

TEST(Prepare, MakesNoLargerOneThanMemoryAllows) {
    std::vector<uint32_t> asked;
    EXPECT_EQ(fitted(32.0, asked, 128).size, 128u);
    ASSERT_EQ(asked.size(), 1u);
    EXPECT_GT(asked.front(), 128u);
    EXPECT_EQ(fitted(1e6, asked, 64).size, 64u);
    EXPECT_EQ(asked.back(), kMaxPageSize) << "no more is ever wanted";
}

TEST(Prepare, PagesByADensityAreAsLargeAsEnginesTakeThem) {
    constexpr uint32_t kUsual = 4096;
    PrepareDesc desc{.path = kRoom, .size = 64, .leastDensity = 1e6, .furnishing = {.density = 10}};
    std::vector<uint32_t> asked;
    desc.fitting = [&](const Scene&, LightmapPages pages, uint32_t edge) {
        asked.push_back(pages.count);
        asked.push_back(edge);
        return 64u;
    };
    desc.pages = 0;
    (void)prepareScene(desc);
    EXPECT_EQ(asked, (std::vector<uint32_t>{1, kUsual}));
    // Four pages of half the edge have as many texels.
    asked.clear();
    desc.leastDensity = 30;
    desc.pages.reset();
    (void)prepareScene(desc);
    desc.pages = 4;
    (void)prepareScene(desc);
    ASSERT_EQ(asked.size(), 4u);
    EXPECT_EQ(asked[2], 4u);
    EXPECT_EQ(2 * asked[3], asked[1]);
}

BakeRequest requestBy(std::vector<std::string> words) {
    CLI::App app;
    BakeOptions options;
    options.patches.size = 64;
    addBakeOptions(app, options);
    std::vector<std::string> all = {kRoom, "-o", "room.exr"};
    all.insert(all.end(), words.begin(), words.end());
    std::reverse(all.begin(), all.end()); // as CLI11 takes them
    app.parse(all);
    return resolveBakeOptions(options);
}

TEST(Prepare, ADensityChoosesTheSizeWhereNoneIsTyped) {
    BakeRequest chosen = requestBy({"--density", "30"});
    const PreparedScene prepared = prepareFor(chosen);
    EXPECT_GT(prepared.size, 64u);
    EXPECT_EQ(chosen.bake.size, prepared.size) << "it is baked at that size";
    EXPECT_EQ(chosen.prepare.size, prepared.size);
    BakeRequest typed = requestBy({"--density", "30", "--size", "64"});
    EXPECT_EQ(prepareFor(typed).size, 64u);
    EXPECT_EQ(typed.bake.size, 64u);
    BakeRequest neither = requestBy({});
    EXPECT_EQ(prepareFor(neither).size, 64u);
}

} // namespace
} // namespace relume
