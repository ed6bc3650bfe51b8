// This tests lightmaps of several pages: where pages lie on their sheet, how objects are dealt to them, and
// what an unwrap and an atlas make of that.
#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/page_deal.h"
#include "assets/atlas/unwrap.h"
#include "assets/atlas/world_mesh.h"
#include "assets/gltf/gltf.h"
#include "tests/log_capture.h"
#include "tests/temporary_folder.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace relume {
namespace {

constexpr uint32_t kEdge = 96;

/// Makes cubes and balls of several sizes.
Scene manyObjects(int count = 9) {
    Scene scene;
    scene.path = "objects.glb";
    const int cube = test::addMesh(scene, test::cube(), "Cube"),
              ball = test::addMesh(scene, test::sphere(10), "Ball");
    for (int i = 0; i < count; ++i) {
        const glm::mat4 place = glm::translate(glm::mat4(1), glm::vec3(4 * i, 0, 0));
        test::addInstance(scene, i % 3 == 2 ? ball : cube,
                          glm::scale(place, glm::vec3(1.0f + 0.15f * float(i))));
        scene.instances.back().name = "Object " + std::to_string(i);
    }
    return scene;
}

UnwrapDesc onPages(uint32_t pages, double density = 0.0) {
    return {.density = density, .size = kEdge, .onlyMissing = true, .threads = 0, .pages = pages};
}

TEST(LightmapPages, LieInTheLeastSquareRowByRow) {
    EXPECT_EQ(LightmapPages{1}.columns(), 1u);
    EXPECT_EQ(LightmapPages{2}.columns(), 2u);
    EXPECT_EQ(LightmapPages{4}.columns(), 2u);
    EXPECT_EQ(LightmapPages{5}.columns(), 3u);
    EXPECT_EQ(LightmapPages{64}.columns(), 8u);
    for (uint32_t count = 1; count <= kMostPages; ++count) {
        const LightmapPages pages{count};
        std::set<std::pair<uint32_t, uint32_t>> cells;
        for (uint32_t page = 0; page < count; ++page) {
            const glm::uvec2 cell = pages.cellOf(page);
            EXPECT_LT(std::max(cell.x, cell.y), pages.columns());
            EXPECT_TRUE(cells.emplace(cell.x, cell.y).second) << count << " pages, page " << page;
        }
        EXPECT_EQ(pages.edgeOf(pages.sheetOf(40)), 40u);
    }
}

TEST(LightmapPages, UvsOfAPageStayOnIt) {
    const glm::vec2 any(0.3f, 1.0f);
    EXPECT_EQ(LightmapPages{1}.onSheet(any, 0), any) << "to the bit";
    const LightmapPages pages{6};
    for (uint32_t page = 0; page < pages.count; ++page)
        for (const glm::vec2 uv : {glm::vec2(0), glm::vec2(1), glm::vec2(0.5f, 0), glm::vec2(1, 0.25f)}) {
            constexpr float kSheet = 3 * 8192;
            const glm::vec2 at = pages.onSheet(uv, page) * kSheet;
            const glm::vec2 low = glm::vec2(pages.cellOf(page)) * 8192.0f;
            EXPECT_GT(at.x, low.x);
            EXPECT_GT(at.y, low.y);
            EXPECT_LT(at.x, low.x + 8192.0f);
            EXPECT_LT(at.y, low.y + 8192.0f);
            EXPECT_LT(glm::length(at - low - uv * 8192.0f), 0.02f);
        }
    EXPECT_TRUE(LightmapPages::together(8, {7, 7}, {0, 0}));
    EXPECT_FALSE(LightmapPages::together(8, {7, 7}, {8, 7}));
    EXPECT_FALSE(LightmapPages::together(8, {7, 7}, {7, 8}));
}

TEST(LightmapPages, AsManyAsADensityNeeds) {
    EXPECT_EQ(pagesForDensity(100.0, 10.0, 1.0, 100), 1u); // 10,000 texels
    EXPECT_EQ(pagesForDensity(100.0, 10.0, 0.5, 100), 2u);
    EXPECT_EQ(pagesForDensity(101.0, 10.0, 1.0, 100), 2u);
    EXPECT_EQ(pagesForDensity(0.0, 10.0, 1.0, 100), 1u);
    EXPECT_EQ(pagesForDensity(1e30, 1e30, 1.0, 100), kMostPages);
    EXPECT_EQ(pagesForDensity(1.0, 1.0, 0.0, 100), kMostPages);
}

TEST(PageDeal, FillsPagesAlikeAndFollowsTheOrder) {
    const std::vector<double> areas = {1, 8, 2, 7, 3, 6, 4, 5};
    const std::vector<uint32_t> dealt = dealToPages(areas, 3);
    std::vector<double> load(3, 0.0);
    for (size_t i = 0; i < areas.size(); ++i)
        load[dealt[i]] += areas[i];
    EXPECT_EQ(*std::max_element(load.begin(), load.end()), 13.0);
    EXPECT_EQ(*std::min_element(load.begin(), load.end()), 11.0);
    EXPECT_EQ(dealToPages(std::vector<double>{1, 1, 1}, 2), (std::vector<uint32_t>{0, 1, 0}));
    EXPECT_EQ(dealToPages(std::vector<double>{1}, 2, std::vector<double>{3, 2}), (std::vector<uint32_t>{1}));
}

// Looks at the pages of an atlas that an unwrap made.
void expectGoodPages(const Scene& scene, uint32_t pages, double density) {
    ASSERT_EQ(scene.pages, pages);
    const LightmapAtlas atlas = buildAtlas(scene, kEdge, true);
    EXPECT_FALSE(atlas.repacked);
    ASSERT_EQ(atlas.pages.count, pages);
    const AtlasStatistics statistics = measureAtlas(scene, atlas, kEdge);
    EXPECT_EQ(statistics.overlap, 0.0);
    EXPECT_NEAR(statistics.texelDensityMean, density, 0.03 * density);
    std::vector<double> covered(pages, 0.0);
    constexpr float kBorder = 1.0f / kEdge - 1e-6f;
    for (const Instance& instance : scene.instances) {
        const Primitive& primitive = scene.meshes[static_cast<size_t>(instance.mesh)].primitives[0];
        for (size_t i = 0; i < primitive.indices.size(); i += 3) {
            const glm::vec2 a = primitive.texCoord1[primitive.indices[i]],
                            b = primitive.texCoord1[primitive.indices[i + 1]] - a,
                            c = primitive.texCoord1[primitive.indices[i + 2]] - a;
            const double area = 0.5 * std::abs(b.x * c.y - b.y * c.x);
            covered[instance.page] += area;
            if (area == 0.0) continue;
            for (const glm::vec2& uv : {a, a + b, a + c}) {
                ASSERT_GE(std::min(uv.x, uv.y), kBorder) << "a texel along the page's edge stays empty";
                ASSERT_LE(std::max(uv.x, uv.y), 1.0f - kBorder);
            }
        }
    }
    const auto [least, most] = std::minmax_element(covered.begin(), covered.end());
    EXPECT_GT(*least, 0.6 * *most) << "pages are filled alike";
    EXPECT_GT(*most, 0.4);
}

TEST(UnwrapPages, EveryObjectLiesOnOnePage) {
    Scene one = manyObjects(), scene = manyObjects();
    const UnwrapResult single = unwrap(one, onPages(1)), result = unwrap(scene, onPages(3));
    EXPECT_EQ(single.pages, 1u);
    EXPECT_EQ(result.pages, 3u);
    EXPECT_EQ(result.size, kEdge);
    EXPECT_EQ(result.objects, 9u);
    EXPECT_GT(result.density, 1.5 * single.density) << "three times the texels";
    expectGoodPages(scene, 3, result.density);
}

TEST(UnwrapPages, AreTheSameOnAnyNumberOfThreads) {
    Scene a = manyObjects(), b = manyObjects();
    UnwrapDesc desc = onPages(4);
    desc.threads = 1;
    unwrap(a, desc);
    desc.threads = 3;
    unwrap(b, desc);
    ASSERT_EQ(a.instances.size(), b.instances.size());
    for (size_t i = 0; i < a.instances.size(); ++i) {
        EXPECT_EQ(a.instances[i].page, b.instances[i].page);
        EXPECT_EQ(a.meshes[static_cast<size_t>(a.instances[i].mesh)].primitives[0].texCoord1,
                  b.meshes[static_cast<size_t>(b.instances[i].mesh)].primitives[0].texCoord1);
    }
}

TEST(UnwrapPages, AsManyAsTheDensityNeedsAndNoMore) {
    Scene few = manyObjects(), many = manyObjects(), large = manyObjects(1);
    const UnwrapResult one = unwrap(few, onPages(0, 3.0));
    EXPECT_EQ(one.pages, 1u);
    const UnwrapResult several = unwrap(many, onPages(0, 8.0));
    EXPECT_GT(several.pages, 1u);
    EXPECT_LT(several.pages, 5u);
    EXPECT_NEAR(several.density, 8.0, 0.05);
    const LogCapture capture;
    const UnwrapResult alone = unwrap(large, onPages(0, 1000.0));
    EXPECT_EQ(alone.pages, 1u) << "more pages would not help an object that is alone";
    EXPECT_NE(capture.text().find("do not fit"), std::string::npos);
    EXPECT_THROW(unwrap(large, {.density = 0.0, .size = 64, .onlyMissing = false, .threads = 0, .pages = 0}),
                 Error);
}

TEST(UnwrapPages, EmptyOnesAreWarnedAbout) {
    Scene scene = manyObjects(2);
    const LogCapture capture;
    EXPECT_EQ(unwrap(scene, onPages(4)).pages, 4u);
    EXPECT_NE(capture.text().find("2 of 4 pages stay empty"), std::string::npos) << capture.text();
}

TEST(UnwrapPages, SizeFollowsFromDensity) {
    Scene scene = manyObjects();
    UnwrapDesc desc = onPages(4, 16.0);
    desc.size = 0;
    const UnwrapResult result = unwrap(scene, desc);
    EXPECT_EQ(result.size % kPageStep, 0u);
    EXPECT_EQ(result.density, 16.0);
    EXPECT_FALSE(buildAtlas(scene, result.size, true).repacked);
}

TEST(UnwrapPages, MemoryKeepsObjectsOnTheirPages) {
    UnwrapMemory memory;
    Scene first = manyObjects(), again = manyObjects(), more = manyObjects();
    unwrap(first, onPages(3, 6.0), &memory);
    EXPECT_EQ(unwrap(again, onPages(3, 6.0), &memory).stayed, 9u);
    test::addInstance(more, 0, glm::scale(glm::mat4(1), glm::vec3(0.7f)));
    more.instances[4].transform = glm::scale(glm::mat4(1), glm::vec3(0.5f));
    EXPECT_EQ(unwrap(more, onPages(3, 6.0), &memory).stayed, 8u);
    for (size_t i = 0; i < first.instances.size(); ++i) {
        EXPECT_EQ(first.instances[i].page, again.instances[i].page);
        if (i != 4) {
            EXPECT_EQ(first.instances[i].page, more.instances[i].page);
        }
    }
    const LightmapAtlas atlas = buildAtlas(more, kEdge, true);
    EXPECT_FALSE(atlas.repacked);
    EXPECT_EQ(measureAtlas(more, atlas, kEdge).overlap, 0.0);
    Scene fewer = manyObjects();
    EXPECT_EQ(unwrap(fewer, onPages(2, 6.0), &memory).stayed, 0u) << "another number of pages begins anew";
}

TEST(AtlasPages, AFileKeepsThem) {
    const TemporaryFolder folder;
    Scene scene = manyObjects();
    unwrap(scene, onPages(5));
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kEdge, true));
    saveGlb(scene, folder.path("pages.glb"));
    const Scene read = loadGltf(folder.path("pages.glb"));
    EXPECT_TRUE(read.warnings.empty());
    EXPECT_EQ(read.pages, 5u);
    for (size_t i = 0; i < scene.instances.size(); ++i)
        EXPECT_EQ(read.instances[i].page, scene.instances[i].page);
    EXPECT_EQ(flatten(read, buildAtlas(read, kEdge, true)).lightmapUv, mesh.lightmapUv);
}

TEST(AtlasPages, UvsOfOneAtlasArePackedAnewOntoSeveral) {
    Scene scene = manyObjects();
    unwrap(scene, onPages(1));
    const LightmapAtlas atlas = buildAtlas(scene, kEdge, true, LightmapPages{3});
    EXPECT_TRUE(atlas.repacked);
    EXPECT_EQ(measureAtlas(scene, atlas, kEdge).overlap, 0.0);
    // As a file it has them in 0 to 1 of each page, and is as it is.
    const Scene placed = withAtlas(scene, atlas);
    EXPECT_EQ(placed.pages, 3u);
    const LightmapAtlas again = buildAtlas(placed, kEdge, true);
    EXPECT_FALSE(again.repacked);
    EXPECT_EQ(flatten(placed, again).lightmapUv, flatten(scene, atlas).lightmapUv);
    // And back onto one.
    const LightmapAtlas one = buildAtlas(placed, kEdge, true, LightmapPages{1});
    EXPECT_TRUE(one.repacked);
    EXPECT_EQ(measureAtlas(placed, one, kEdge).overlap, 0.0);
}

TEST(AtlasPages, AMeshMayBeOnSeveral) {
    Scene scene;
    scene.path = "squares.glb";
    scene.pages = 2;
    const int mesh = test::addMesh(scene, test::square());
    test::addInstance(scene, mesh);
    test::addInstance(scene, mesh);
    scene.instances[1].page = 1;
    EXPECT_FALSE(buildAtlas(scene, 64).repacked);
    scene.instances[1].page = 0;
    EXPECT_TRUE(buildAtlas(scene, 64).repacked) << "both cover page 0";
}

TEST(AtlasPages, TooSmallOnesAreRefused) {
    Scene scene = manyObjects(3);
    unwrap(scene, onPages(1));
    EXPECT_THROW(buildAtlas(scene, 2, true, LightmapPages{2}), Error);
    EXPECT_THROW(unwrap(scene, {.density = 0, .size = 2, .onlyMissing = false, .threads = 0, .pages = 2}),
                 Error);
}

} // namespace
} // namespace relume
