#include "assets/atlas/lightmap_atlas.h"

#include "assets/atlas/rect_pack.h"
#include "assets/atlas/uv_grid.h"
#include "assets/atlas/uv_sets.h"
#include "assets/base/error.h"
#include "assets/base/worker_pool.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace relume {
namespace {

bool warns(const LightmapAtlas& atlas, const std::string& part) {
    return std::any_of(atlas.warnings.begin(), atlas.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

/// Holds the bounds of an instance of the unit-square UVs, in texels.
struct TexelBox {
    glm::vec2 low, high;
};
TexelBox boxOf(const AtlasRect& rect, uint32_t size) {
    return {rect.offset * float(size), (rect.offset + rect.scale) * float(size)};
}

/// Makes the two halves of a square, whose UVs have been moved over each other by `shift`.
Primitive overlappingHalves(float shift) {
    Primitive p = test::primitiveOf(
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}},
        {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7});
    const float a = 0.5f - shift;
    p.texCoord1 = {{0, 0}, {.5f, 0}, {.5f, 1}, {0, 1}, {a, 0}, {1, 0}, {1, 1}, {a, 1}};
    return p;
}

TEST(UvGrid, SharedEdgesNeverCountTwiceAndLeaveNoGap) {
    // There is a fan of slivers around a point that is on no cell's corner, in both windings.
    UvGrid grid(64, glm::dvec2(0), glm::dvec2(1));
    std::vector<glm::dvec2> rim;
    for (int i = 0; i <= 64; ++i)
        rim.push_back({i / 64.0, 0});
    for (int i = 1; i <= 64; ++i)
        rim.push_back({1, i / 64.0});
    for (int i = 63; i >= 0; --i)
        rim.push_back({i / 64.0, 1});
    for (int i = 63; i >= 0; --i)
        rim.push_back({0, i / 64.0});
    const glm::dvec2 centre(0.501, 0.437);
    for (size_t i = 0; i + 1 < rim.size(); ++i)
        i % 2 ? grid.add(centre, rim[i], rim[i + 1]) : grid.add(rim[i + 1], rim[i], centre);
    EXPECT_EQ(grid.covered(), 64u * 64u);
    EXPECT_EQ(grid.overlapped(), 0u);
    EXPECT_FALSE(grid.addIfFree({0, 0}, {.1, 0}, {0, .1}));
    EXPECT_EQ(grid.overlapped(), 0u);
}

TEST(UvGrid, CoversAreaAndIgnoresWhatIsOutside) {
    UvGrid grid(1000, glm::dvec2(0), glm::dvec2(2));
    grid.add({0, 0}, {1, 0}, {0, 1}); // half of a quarter of the grid
    EXPECT_NEAR(static_cast<double>(grid.covered()) / static_cast<double>(grid.cells()), 0.125, 1e-3);
    UvGrid outside(100, glm::dvec2(0), glm::dvec2(1));
    outside.add({-1e9, -1e9}, {-1, 2}, {-1, -1});
    outside.add({2, 2}, {1e30, 2}, {2, 1e30});
    EXPECT_EQ(outside.covered(), 0u);
    outside.add({-3, -3}, {5, -3}, {-3, 5}); // its long edge runs from (2,0) to (0,2)
    EXPECT_EQ(outside.covered(), 100u * 100u);
}

TEST(UvGrid, ThreadsThatAddBesideEachOtherCountAsOneDoes) {
    constexpr uint32_t kThreads = 4, kEach = 2000;
    const auto triangle = [](uint32_t i) {
        const glm::dvec2 at(std::fmod(0.618034 * i, 0.9), std::fmod(0.754878 * i, 0.9));
        return std::array<glm::dvec2, 3>{at, at + glm::dvec2(0.08, 0.01), at + glm::dvec2(0.02, 0.09)};
    };
    UvGrid one(128, glm::dvec2(0), glm::dvec2(1)), shared(128, glm::dvec2(0), glm::dvec2(1));
    for (uint32_t i = 0; i < kThreads * kEach; ++i) {
        const auto [a, b, c] = triangle(i);
        one.add(a, b, c);
    }
    std::array<UvGrid::Added, kThreads> added;
    WorkerPool pool(kThreads);
    pool.run(kThreads, [&](uint32_t thread) {
        for (uint32_t i = thread; i < kThreads * kEach; i += kThreads) {
            const auto [a, b, c] = triangle(i);
            shared.addBeside(a, b, c, added[thread]);
        }
    });
    for (const UvGrid::Added& own : added)
        shared.count(own);
    EXPECT_EQ(shared.covered(), one.covered());
    EXPECT_EQ(shared.overlapped(), one.overlapped());
    EXPECT_EQ(shared.visits(), one.visits());
    EXPECT_GT(one.overlapped(), one.covered() / 2);
    for (uint32_t y = 0; y < 128; ++y)
        for (uint32_t x = 0; x < 128; ++x)
            ASSERT_EQ(shared.count(x, y), one.count(x, y)) << x << ", " << y;
}

// Each of them covers the whole set: without an end, cells times triangles would be visited, by several
// threads alike.
TEST(LightmapSet, ManySquaresUponEachOtherAreSoonGivenUp) {
    constexpr uint32_t kSquares = 60'000;
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < kSquares; ++i) {
        const float x = static_cast<float>(i);
        positions.insert(positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}});
        for (const uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u})
            indices.push_back(4 * i + corner);
    }
    Primitive squares = test::primitiveOf(positions, indices);
    for (uint32_t i = 0; i < kSquares; ++i)
        squares.texCoord1.insert(squares.texCoord1.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    Scene scene = test::sceneOf(squares);
    EXPECT_EQ(countUnmapped(scene), 1u);
    WorkerPool pool(4);
    const std::vector<MeshChoice> choices = chooseSets(scene, pool);
    EXPECT_EQ(choices.at(0).texCoord, -1);
    // Two squares of two grids, of 2048 x 2048 cells at most, and what four threads do at the same time.
    EXPECT_LT(choices.at(0).visits, 2u * (2 + 4) * 2048 * 2048);
}

TEST(RectPack, KeepsTheGutterAndTheBounds) {
    std::vector<PackedRect> rects;
    for (uint32_t i = 0; i < 60; ++i)
        rects.push_back({1 + i % 7, 1 + i % 5});
    ASSERT_TRUE(packRects(rects, 64, 64, 2));
    for (const PackedRect& a : rects) {
        EXPECT_LE(a.x + a.width, 64u);
        EXPECT_LE(a.y + a.height, 64u);
        for (const PackedRect& b : rects)
            EXPECT_TRUE(&a == &b || a.x + a.width + 2 <= b.x || b.x + b.width + 2 <= a.x ||
                        a.y + a.height + 2 <= b.y || b.y + b.height + 2 <= a.y);
    }
    EXPECT_FALSE(packRects(rects, 16, 16, 2));
    std::vector<PackedRect> whole = {{64, 64}};
    EXPECT_TRUE(packRects(whole, 64, 64, 2)); // no gutter along the rim
}

TEST(Atlas, OneAtlasIsUsedAsItIs) {
    Scene scene;
    test::addInstance(scene, test::addMesh(scene, test::square({0, 0}, {.5f, 1})));
    test::addInstance(scene, test::addMesh(scene, test::square({.5f, 0}, {1, .5f})));
    const LightmapAtlas atlas = buildAtlas(scene, 64);
    EXPECT_FALSE(atlas.repacked);
    EXPECT_TRUE(atlas.warnings.empty());
    for (const AtlasRect& rect : atlas.instances) {
        EXPECT_EQ(rect.texCoord, 1);
        EXPECT_EQ(rect.scale, glm::vec2(1));
        EXPECT_EQ(rect.offset, glm::vec2(0));
    }
    const AtlasStatistics statistics = measureAtlas(scene, atlas, 64);
    EXPECT_NEAR(statistics.coverage, 0.75, 1e-3);
    EXPECT_EQ(statistics.overlap, 0.0);
    EXPECT_NEAR(statistics.texelDensityMax, 64 * std::sqrt(0.5), 1e-3);
    EXPECT_NEAR(statistics.texelDensityMin, 64 * 0.5, 1e-3);
    EXPECT_NEAR(statistics.texelDensityMean, 64 * std::sqrt(0.375), 1e-3);
}

TEST(Atlas, InstancesGetRectanglesByWorldArea) {
    Scene scene;
    const int mesh = test::addMesh(scene, test::square());
    test::addInstance(scene, mesh);
    test::addInstance(scene, mesh, glm::scale(glm::mat4(1), glm::vec3(2)));
    test::addInstance(scene, mesh, glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1)));
    const LightmapAtlas atlas = buildAtlas(scene, 256);
    ASSERT_TRUE(atlas.repacked);
    std::vector<TexelBox> boxes;
    for (const AtlasRect& rect : atlas.instances)
        boxes.push_back(boxOf(rect, 256));
    for (const TexelBox& box : boxes) {
        for (int c = 0; c < 2; ++c) { // on whole texels, inside
            EXPECT_NEAR(box.low[c], std::round(box.low[c]), 1e-3f);
            EXPECT_NEAR(box.high[c], std::round(box.high[c]), 1e-3f);
            EXPECT_GE(box.low[c], 0.0f);
            EXPECT_LE(box.high[c], 256.0f);
        }
        for (const TexelBox& other : boxes)
            EXPECT_TRUE(&box == &other || box.high.x + 2 <= other.low.x + 1e-3f ||
                        other.high.x + 2 <= box.low.x + 1e-3f || box.high.y + 2 <= other.low.y + 1e-3f ||
                        other.high.y + 2 <= box.low.y + 1e-3f);
    }
    EXPECT_NEAR(atlas.instances[1].scale.x / atlas.instances[0].scale.x, 2.0f, 0.03f);
    EXPECT_EQ(atlas.instances[0].scale, atlas.instances[2].scale);
    const AtlasStatistics statistics = measureAtlas(scene, atlas, 256);
    EXPECT_EQ(statistics.overlap, 0.0);
    EXPECT_GT(statistics.coverage, 0.5);
    EXPECT_NEAR(statistics.texelDensityMin, statistics.texelDensityMax, 0.02 * statistics.texelDensityMax);
}

TEST(Atlas, RectanglesFollowTheUvsOwnBounds) {
    // The mesh uses a quarter of its unit square, at twice the aspect.
    Scene scene;
    const int mesh = test::addMesh(scene, test::square({.5f, .25f}, {1, .5f}));
    test::addInstance(scene, mesh);
    test::addInstance(scene, mesh);
    const LightmapAtlas atlas = buildAtlas(scene, 128);
    ASSERT_TRUE(atlas.repacked);
    EXPECT_GT(measureAtlas(scene, atlas, 128).coverage, 0.9);
    for (const AtlasRect& rect : atlas.instances) {
        const glm::vec2 low = glm::vec2(.5f, .25f) * rect.scale + rect.offset;
        const glm::vec2 high = glm::vec2(1, .5f) * rect.scale + rect.offset;
        EXPECT_GE(std::min(low.x, low.y), -1e-6f);
        EXPECT_LE(std::max(high.x, high.y), 1 + 1e-6f);
    }
}

TEST(Atlas, OverlapAboveOnePercentIsRefused) {
    EXPECT_EQ(lightmapSet({"", {overlappingHalves(0)}}), 1);
    EXPECT_EQ(lightmapSet({"", {overlappingHalves(0.008f)}}), 1);
    EXPECT_EQ(lightmapSet({"", {overlappingHalves(0.02f)}}), -1);
    // The share counts, not the place: this is the same mesh in a corner of an atlas.
    for (float shift : {0.008f, 0.02f}) {
        Primitive small = overlappingHalves(shift);
        for (glm::vec2& uv : small.texCoord1)
            uv = uv / 64.0f + 0.5f;
        EXPECT_EQ(lightmapSet({"", {small}}), shift < 0.01f ? 1 : -1);
    }
    Scene scene = test::sceneOf(overlappingHalves(0.02f));
    scene.meshes[0].name = "Wall";
    try {
        buildAtlas(scene, 64);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()), "test.glb: no mesh has usable lightmap UVs (mesh 'Wall' has a "
                                             "TEXCOORD_1 overlapping itself by more "
                                             "than 1 %): run 'relume unwrap' or leave out --no-unwrap");
    }
}

/// Makes so many squares beside each other, each a mesh of its own whose UVs are those of all others.
Scene squaresOfTheSameUvs(int count) {
    Scene scene;
    scene.path = "squares.glb";
    for (int i = 0; i < count; ++i)
        test::addInstance(scene, test::addMesh(scene, test::square()),
                          glm::translate(glm::mat4(1), glm::vec3(2 * i, 0, 0)));
    return scene;
}

TEST(Atlas, MeshesOfTheSameUvsCostNoWholeGridEach) {
    const LightmapAtlas atlas = buildAtlas(squaresOfTheSameUvs(300), 256);
    EXPECT_TRUE(atlas.repacked);
    // Each mesh's own grid has 128 x 128 cells; that of the atlas, 2048 x 2048, is given up at the second
    // square.
    EXPECT_LT(atlas.visits, 300u * 128u * 128u + 3u * 2048u * 2048u);
}

TEST(Atlas, TrianglesOfTheSameUvsCostNoWholeGridEach) {
    Primitive stacked;
    for (int i = 0; i < 4000; ++i) {
        const Primitive one = test::square();
        for (uint32_t index : one.indices)
            stacked.indices.push_back(index + static_cast<uint32_t>(stacked.positions.size()));
        for (size_t v = 0; v < one.positions.size(); ++v) {
            stacked.positions.push_back(one.positions[v] + glm::vec3(0, 0, i));
            stacked.normals.push_back(one.normals[v]);
            stacked.texCoord1.push_back(one.texCoord1[v]);
        }
    }
    Scene scene = squaresOfTheSameUvs(1);
    test::addInstance(scene, test::addMesh(scene, stacked));
    const LightmapAtlas atlas = buildAtlas(scene, 256);
    EXPECT_EQ(atlas.instances[1].texCoord, -1);
    EXPECT_TRUE(warns(atlas, "overlapping itself by more than 1 %"));
    EXPECT_LT(atlas.visits, 3u * 2048u * 2048u); // of 8000 times half of 512 x 512
}

TEST(Atlas, MeshesWithoutUsableUvsBlockLightOnly) {
    Scene scene = test::sceneOf(test::square({0, 0}, {.5f, .5f}));
    Primitive bare = test::square();
    bare.texCoord1.clear();
    test::addInstance(scene, test::addMesh(scene, bare, "Bare"));
    test::addInstance(scene, test::addMesh(scene, test::square({0, 0}, {3, 3}), "Tiled"));
    test::addInstance(scene, test::addMesh(scene, test::square({.5f, .5f}, {.5f, .5f}), "Point"));
    const LightmapAtlas atlas = buildAtlas(scene, 64);
    EXPECT_FALSE(atlas.repacked);
    EXPECT_EQ(atlas.instances[0].texCoord, 1);
    for (size_t i = 1; i < 4; ++i)
        EXPECT_EQ(atlas.instances[i].texCoord, -1);
    EXPECT_TRUE(warns(atlas, "mesh 'Bare': has no TEXCOORD_1"));
    EXPECT_TRUE(warns(atlas, "mesh 'Tiled': has a TEXCOORD_1 outside [0,1]"));
    EXPECT_TRUE(warns(atlas, "mesh 'Point': has a TEXCOORD_1 without area"));
    for (const std::string& warning : atlas.warnings)
        EXPECT_NE(warning.find("run 'relume unwrap' or leave out --no-unwrap"), std::string::npos) << warning;
}

TEST(Atlas, TexCoord0StandsInWhereItIsAnAtlas) {
    Primitive p = test::square();
    p.texCoord0 = p.texCoord1;
    p.texCoord1.clear();
    Scene scene = test::sceneOf(p);
    EXPECT_EQ(buildAtlas(scene, 64).instances[0].texCoord, 0);
    scene.meshes[0].primitives[0].texCoord1 = {{0, 0}, {2, 0}, {2, 2}, {0, 2}}; // no atlas
    const LightmapAtlas atlas = buildAtlas(scene, 64);
    EXPECT_EQ(atlas.instances[0].texCoord, 0);
    EXPECT_TRUE(warns(atlas, "TEXCOORD_0 is taken instead"));
    scene.meshes[0].primitives[0].texCoord1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    EXPECT_EQ(buildAtlas(scene, 64).instances[0].texCoord, 1);
}

TEST(Atlas, TooManyInstancesForTheSizeIsAnError) {
    Scene scene;
    scene.path = "crowd.glb";
    const int mesh = test::addMesh(scene, test::square());
    for (int i = 0; i < 200; ++i)
        test::addInstance(scene, mesh);
    try {
        buildAtlas(scene, 32);
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("use a larger --size"), std::string::npos);
    }
    EXPECT_TRUE(buildAtlas(scene, 128).repacked);
}

TEST(Atlas, SceneWithoutAnyUvsIsAnError) {
    Primitive bare = test::square();
    bare.texCoord1.clear();
    EXPECT_THROW(buildAtlas(test::sceneOf(bare), 64), Error);
}

TEST(Atlas, ReferenceScenesAreUsedAsTheyAre) {
    const std::string folder = std::string(RELUME_SHARED_DIR) + "/scenes/rtrad/";
    if (!std::filesystem::exists(folder + "Multilayer.glb"))
        GTEST_SKIP() << "no " << folder << " here: the reference scenes are not part of the project";
    // These are the coverages that the converter which made the files measured.
    const std::pair<const char*, double> scenes[] = {{"CornellLucy.glb", 0.702},
                                                     {"CornellGeom.glb", 0.879},
                                                     {"Multilayer.glb", 0.743},
                                                     {"Nvidia_Scene.glb", 0.893},
                                                     {"TextureScene.glb", 0.819}};
    for (const auto& [name, coverage] : scenes) {
        const Scene scene = loadGltf(folder + name);
        const LightmapAtlas atlas = buildAtlas(scene, 128);
        EXPECT_FALSE(atlas.repacked) << name;
        EXPECT_TRUE(atlas.warnings.empty()) << name;
        const AtlasStatistics statistics = measureAtlas(scene, atlas, 128);
        EXPECT_NEAR(statistics.coverage, coverage, 0.002) << name;
        EXPECT_LT(statistics.overlap, 0.001) << name;
    }
}

} // namespace
} // namespace relume
