// Here links start from a coarser grid of patches and are interpolated within charts.
#include "assets/generate/generate.h"
#include "bake/gather/coarse_patches.h"
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

struct IndirectScaleCase {
    Method method;
    uint32_t scale;
};

std::string caseName(const testing::TestParamInfo<IndirectScaleCase>& info) {
    return std::string(methodName(info.param.method)) + std::to_string(info.param.scale);
}

glm::vec2 texelOf(const shader::Patch& patch, uint32_t size) {
    const uint32_t key = shader::patchTexel(patch.flags);
    return {static_cast<float>(key % size), static_cast<float>(key / size)};
}

} // namespace

class IndirectScale : public testing::TestWithParam<IndirectScaleCase> {};
INSTANTIATE_TEST_SUITE_P(All, IndirectScale,
                         testing::Values(IndirectScaleCase{Method::Directional, 2},
                                         IndirectScaleCase{Method::Directional, 4},
                                         IndirectScaleCase{Method::Hybrid, 2},
                                         IndirectScaleCase{Method::Hybrid, 4}),
                         caseName);

TEST_P(IndirectScale, FurnaceEndsAtTheSeriesLimit) {
    constexpr float kAlbedo = 0.5f;
    SceneMaker maker(64);
    const auto walls =
        maker.box({3, 1, -2}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(kAlbedo, 1.0f), 20);
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size(),
                                                  .passes = 0,
                                                  .error = 0.002,
                                                  .method = GetParam().method,
                                                  .samples = 1024,
                                                  .indirectScale = GetParam().scale});
    for (const TexelRect& wall : walls) {
        const TexelStatistics s = statistics(baked.radiance, wall);
        EXPECT_EQ(s.count, wall.width * wall.height);
        EXPECT_NEAR(s.mean, 1.0 / (1.0 - kAlbedo), 0.004 / (1.0 - kAlbedo));
        EXPECT_GT(s.min, 0.97 / (1.0 - kAlbedo));
        EXPECT_LT(s.max, 1.03 / (1.0 - kAlbedo));
    }
}

// Charts have 20 and 12 texels, so windows of the grid hold parts of several.
TEST_P(IndirectScale, ADarkCellStaysDark) {
    SceneMaker maker(128);
    maker.box({-1, -1, -1}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.8f, 1.0f), 19);
    const auto cell =
        maker.box({-0.3f, -0.3f, -0.3f}, {0.6f * kX, 0.6f * kY, 0.6f * kZ}, maker.material(0.8f), 11);
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size(),
                                                  .passes = 3,
                                                  .method = GetParam().method,
                                                  .samples = 64,
                                                  .smooth = true,
                                                  .indirectScale = GetParam().scale});
    for (const TexelRect& wall : cell)
        EXPECT_EQ(statistics(baked.lighting, wall).max, 0.0);
}

TEST_P(IndirectScale, CacheAndBatchesChangeNoByte) {
    const Scene scene = generateScene("cornell_geom");
    const BakeDesc desc{.size = 64,
                        .passes = 3,
                        .method = GetParam().method,
                        .samples = 32,
                        .indirectScale = GetParam().scale};
    const Baked first = bakeScene(scene, desc);
    EXPECT_EQ(first.progress.cachedShare, 1.0);
    EXPECT_GT(first.progress.raysSaved, 0u);
    BakeDesc other = desc;
    other.batchMs = 1;
    other.cache.kind = CacheSettings::Kind::None;
    const Baked without = bakeScene(scene, other);
    EXPECT_EQ(without.lighting.planes, first.lighting.planes);
    EXPECT_EQ(without.progress.raysSaved, 0u);
    EXPECT_GT(without.progress.rays, first.progress.rays);
}

// They are a quarter and a sixteenth, but for charts' edges; what is kept shrinks alike. With the directional
// method all rays are links.
TEST(IndirectScaleRays, FollowTheGrid) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc{.size = 128, .passes = 2, .method = Method::Directional, .samples = 16};
    const SolverProgress all = bakeScene(scene, desc).progress;
    for (const auto& [scale, most] : {std::pair(2u, 0.28), std::pair(4u, 0.09)}) {
        desc.indirectScale = scale;
        const SolverProgress fewer = bakeScene(scene, desc).progress;
        const auto share = [](uint64_t a, uint64_t b) {
            return static_cast<double>(a) / static_cast<double>(b);
        };
        const double least = 1.0 / (scale * scale);
        EXPECT_GT(share(fewer.rays, all.rays), least);
        EXPECT_LT(share(fewer.rays, all.rays), most);
        EXPECT_LT(share(fewer.raysSaved, all.raysSaved), most);
        EXPECT_LT(share(fewer.cacheBytes, all.cacheBytes), most);
        EXPECT_LT(share(fewer.pairs, all.pairs), most);
    }
}

TEST(IndirectScaleTracers, Agree) {
    const Scene scene = generateScene("cornell_geom");
    const BakeDesc desc{
        .size = 128, .passes = 1, .method = Method::Directional, .samples = 16, .indirectScale = 4};
    expectTracersAgree(scene, desc, 5e-3);
}

// The bake is held against sixteen times the samples of every patch: the grid's own error is part of what is
// told.
TEST(IndirectScaleError, IsTold) {
    for (const char* name : {"cornell_geom", "cornell_layers"}) {
        const Scene scene = generateScene(name);
        BakeDesc desc{.size = 128, .passes = 2, .method = Method::Hybrid, .samples = 1024};
        const Baked reference = bakeScene(scene, desc);
        desc.samples /= 16;
        for (const auto& [scale, most] : {std::pair(2u, 0.05), std::pair(4u, 0.08)}) {
            desc.indirectScale = scale;
            for (const bool smooth : {false, true}) {
                desc.smooth = smooth;
                const Baked baked = bakeScene(scene, desc);
                const double distance = relativeError(baked.lighting, reference.lighting);
                if (std::string(name) == "cornell_geom") {
                    EXPECT_LT(distance, most) << "scale " << scale << ", smoothed: " << smooth;
                }
                EXPECT_NEAR(baked.progress.error / distance, 1.0, 0.3)
                    << name << ", scale " << scale << ", smoothed: " << smooth;
                EXPECT_GT(baked.progress.gridError, 0.0);
                EXPECT_LT(baked.progress.gridError, baked.progress.error);
            }
        }
    }
}

// An error below what the grid leaves cannot be reached: the solver says so instead of sampling for ever.
TEST(IndirectScaleError, EndsWhereTheGridDoes) {
    const Baked baked = bakeScene(generateScene("cornell_geom"), {.size = 64,
                                                                  .passes = 0,
                                                                  .error = 0.004,
                                                                  .method = Method::Hybrid,
                                                                  .smooth = true,
                                                                  .indirectScale = 4});
    EXPECT_FALSE(baked.progress.converged);
    EXPECT_GT(baked.progress.gridError, 0.004);
    EXPECT_LT(baked.progress.samples, 16384u);
}

// Linear slopes along a flat chart come out as they are except beyond the last receivers, and no weight
// reaches another chart.
TEST(CoarsePatches, ReproduceStraightLines) {
    SceneMaker maker(96);
    const TexelRect wall = maker.quad({0, 0, 0}, kX, kY, maker.material(0.5f, 1.0f), {29, 23});
    maker.box({2, 0, 0}, {kX, kY, kZ}, maker.material(0.5f), 13);
    const Baked baked =
        bakeScene(maker.scene(), {.size = maker.size(), .method = Method::Hybrid, .samples = 16});
    const TraceScene& scene = baked.patches.scene;
    const uint32_t size = maker.size();
    for (const uint32_t scale : {2u, 4u}) {
        const CoarsePatches coarse = buildCoarsePatches(baked.patches, scale);
        ASSERT_EQ(coarse.taps.size(), scene.patches.size());
        EXPECT_EQ(coarse.receivers.size() % shader::kChunk, 0u);
        const auto patchOf = [&](uint32_t r) { return coarse.neighbours[r].own; };
        for (uint32_t i = 0; i < baked.patches.count; ++i) {
            const shader::CoarseTaps& taps = coarse.taps[i];
            const uint32_t receivers[] = {taps.receiver0, taps.receiver1, taps.receiver2, taps.receiver3};
            glm::vec2 place(0.0f);
            float sum = 0;
            for (int t = 0; t < 4; ++t) {
                const float w = taps.weights[t];
                if (w == 0.0f) continue;
                EXPECT_GT(w, 0.0f);
                EXPECT_EQ(scene.patchChart[patchOf(receivers[t])], scene.patchChart[i]);
                place += w * texelOf(scene.patches[patchOf(receivers[t])], size);
                sum += w;
            }
            EXPECT_NEAR(sum, 1.0f, 1e-5f);
            const glm::vec2 texel = texelOf(scene.patches[i], size);
            const bool inWall = texel.x >= static_cast<float>(wall.x) &&
                                texel.y >= static_cast<float>(wall.y) &&
                                texel.x < static_cast<float>(wall.x + wall.width) &&
                                texel.y < static_cast<float>(wall.y + wall.height);
            if (!inWall) continue;
            EXPECT_NEAR(place.x, texel.x, 1e-3f);
            EXPECT_NEAR(place.y, texel.y, 1e-3f);
        }
    }
}

} // namespace relume
