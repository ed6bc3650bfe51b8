// This bakes scenes onto several pages and holds them against the same surfaces on one.
#include "assets/atlas/world_mesh.h"
#include "assets/images/metrics.h"
#include "assets/images/paged_image.h"
#include "bake/baker/memory_plan.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace relume {
namespace {

constexpr uint32_t kPage = 48; // [texels]

// A room with a lamp in its ceiling, whose walls are objects of their own.
Scene litRoom() {
    SceneMaker maker(64);
    const int wall = maker.material(0.6f), lamp = maker.material(0.0f, 20.0f);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, wall, 14);
    maker.quad({0.7f, 1.9f, 0.7f}, 0.6f * kX, 0.6f * kZ, lamp, {4, 4});
    Scene scene = maker.scene();
    scene.path = "room.glb";
    return scene;
}

BakeDesc pagedHybrid(uint32_t size) {
    return {.size = size, .passes = 0, .error = 0.0, .method = Method::Hybrid, .samples = 64, .smooth = true};
}

FloatImage bakeOn(const Scene& scene, const LightmapAtlas& atlas, uint32_t size, double batchMs = 20) {
    BakeDesc desc = pagedHybrid(size);
    desc.batchMs = batchMs;
    Baker baker(testDevice(), scene, flatten(scene, atlas), settingsOf(desc));
    while (!baker.solver().done())
        baker.solver().step();
    return baker.lightmap({});
}

TEST(PagedBake, HasTheLightOfTheSameTexelsOnOneMap) {
    const Scene scene = litRoom();
    const LightmapAtlas atlas = buildAtlas(scene, kPage, true, LightmapPages{3});
    ASSERT_EQ(atlas.pages.count, 3u);
    const FloatImage paged = bakeOn(scene, atlas, kPage);
    EXPECT_EQ(paged.width, 2 * kPage);
    EXPECT_EQ(lightmapPagesOf(paged).count, 3u);
    const FloatImage sheet = bakeOn(scene, onOneSheet(atlas), 2 * kPage);
    EXPECT_EQ(lightmapPagesOf(sheet).count, 1u);
    // Texels, patches and their random numbers are those of the sheet; UVs differ by their last bits.
    const ImagePair pair({paged, "pages"}, {sheet, "sheet"});
    EXPECT_LT(pair.measure().relRmse, 1e-3);
    size_t covered = 0, differing = 0;
    for (size_t i = 0; i < paged.planes[3].size(); ++i) {
        covered += paged.planes[3][i] == 1.0f;
        differing += (paged.planes[3][i] == 1.0f) != (sheet.planes[3][i] == 1.0f);
    }
    EXPECT_GT(covered, 2500u);
    EXPECT_EQ(differing, 0u);
    // The place of the sheet that is no page's stays empty.
    for (uint32_t y = kPage; y < 2 * kPage; ++y)
        for (uint32_t x = kPage; x < 2 * kPage; ++x)
            ASSERT_EQ(paged.planes[3][size_t{y} * paged.width + x], 0.0f);
}

TEST(PagedBake, IsTheSameBytesWhateverTheBatches) {
    const Scene scene = litRoom();
    const LightmapAtlas atlas = buildAtlas(scene, kPage, true, LightmapPages{2});
    EXPECT_EQ(bakeOn(scene, atlas, kPage, 20).planes, bakeOn(scene, atlas, kPage, 2).planes);
}

TEST(PagedBake, SizesThatDoNotFitAreRefusedWithOneThatDoes) {
    BakeSettings settings;
    settings.size = 2048;
    constexpr SceneExtent kExtent{.triangles = 1000, .pages = {4}};
    BakeRoom place = roomOn(testDevice());
    place.device = uint64_t{1} << 30;
    const auto problemOf = [&](const SceneExtent& scene) {
        return planMemory(settings, scene, place).problem;
    };
    const std::string problem = problemOf(kExtent);
    ASSERT_TRUE(problem.ends_with(" of 4 pages fits")) << problem;
    const size_t begin = problem.rfind("--size ") + 7;
    const auto fits = static_cast<uint32_t>(std::stoul(problem.substr(begin)));
    EXPECT_LT(fits, settings.size);
    settings.size = fits;
    EXPECT_EQ(problemOf(kExtent), "");
    settings.size = fits + 64;
    EXPECT_NE(problemOf(kExtent), "");
    // However much memory there is, texels are numbered by 29 bits and a device's images have a largest size.
    settings.size = Baker::kMaxSize;
    place.device = uint64_t{1} << 50;
    place.host.reset();
    constexpr SceneExtent kMany{.triangles = 1000, .pages = {64}};
    const std::string tooMany = problemOf(kMany);
    EXPECT_NE(tooMany.find("makes a map of 65536 texels a side"), std::string::npos) << tooMany;
    EXPECT_NE(tooMany.find("of 64 pages fits"), std::string::npos) << tooMany;
    // Fewer pages than the sheet has room for have fewer patches, and so need less.
    settings.size = 2048;
    const auto needed = [&](uint32_t pages) {
        return mostMemoryNeeds(settings, {.triangles = 1000, .pages = {pages}}, true).total();
    };
    EXPECT_LT(needed(5), needed(9));
}

TEST(PagedBake, ASizeThatIsNoMultipleOfATileIsRefused) {
    const Scene scene = litRoom();
    const LightmapAtlas atlas = buildAtlas(scene, 50, true, LightmapPages{2});
    try {
        Baker baker(testDevice(), scene, flatten(scene, atlas), settingsOf(pagedHybrid(50)));
        ADD_FAILURE() << "it was baked";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("give --size 56"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace relume
