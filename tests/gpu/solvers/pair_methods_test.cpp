// Undersampling and adaptive subdivision are held against the pure method and closed forms; the visibility
// cache is tested, too.
#include "assets/generate/generate.h"
#include "bake/pairs/pair_passes.h"
#include "tests/gpu/bake_comparison.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

constexpr uint64_t kSlot = superBytes(false); // what the cache needs for one super-block

struct PairCase {
    const char* name;
    Method method;
    PairSettings pairs;
    double error;          // relRMSE against pure, cornell_geom 128^2, 3 passes
    double flux;           // error of the reflected flux there
    double furnace = 0.02; // relative, of the mean of each wall
};
void PrintTo(const PairCase& c, std::ostream* out) {
    *out << c.name;
}

class PairMethods : public testing::TestWithParam<PairCase> {
protected:
    static BakeDesc desc(uint32_t size, uint32_t passes) {
        return {.size = size, .passes = passes, .method = GetParam().method, .pairs = GetParam().pairs};
    }
};

// Adaptive subdivision merges as much as its threshold lets it: that is its error.
INSTANTIATE_TEST_SUITE_P(
    All, PairMethods,
    testing::Values(PairCase{"static2", Method::Static, {.window = 2}, 0.05, 0.015},
                    PairCase{"static4", Method::Static, {.window = 4}, 0.10, 0.03},
                    PairCase{"montecarlo2", Method::MonteCarlo, {.window = 2}, 0.05, 0.01},
                    PairCase{"montecarlo4", Method::MonteCarlo, {.window = 4}, 0.12, 0.01, 0.15},
                    PairCase{"mipmapped2", Method::Mipmapped, {.window = 2}, 0.04, 0.01},
                    PairCase{"mipmapped4", Method::Mipmapped, {.window = 4}, 0.08, 0.01},
                    PairCase{"adaptive", Method::Adaptive, {.threshold = 0.02}, 0.05, 0.015},
                    PairCase{"adaptive64", Method::Adaptive, {.threshold = 0.05, .node = 64}, 0.20, 0.03}),
    [](const auto& test) { return std::string(test.param.name); });

} // namespace

TEST_P(PairMethods, AreNearPure) {
    static const Scene scene = generateScene("cornell_geom");
    static const Baked pure = bakeScene(scene, {.size = 128, .passes = 3});
    const Baked other = bakeScene(scene, desc(128, 3));
    EXPECT_LT(relativeError(other.lighting, pure.lighting), GetParam().error);
    EXPECT_NEAR(reflectedFlux(other) / reflectedFlux(pure), 1.0, GetParam().flux);
    EXPECT_LT(other.progress.rays, pure.progress.rays);
}

// The radiance is emission / (1 - albedo) everywhere, in the mean within the form factors' error. What
// Monte-Carlo draws for a chunk stays for all bounces: in so small a room its rows sum to 1 in the mean only.
TEST_P(PairMethods, FurnaceEndsAtTheSeriesLimit) {
    SceneMaker maker(64);
    const auto walls = maker.box({3, 1, -2}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}},
                                 maker.material(0.5f, 1.0f), 20); // no multiple of the windows
    BakeDesc bake = desc(maker.size(), 0);
    bake.error = 1e-4;
    const Baked baked = bakeScene(maker.scene(), bake);
    EXPECT_TRUE(baked.progress.converged);
    for (const TexelRect& wall : walls)
        EXPECT_NEAR(statistics(baked.radiance, wall).mean, 2.0, 2.0 * GetParam().furnace);
}

// Windows reach across charts in the lightmap; light does not.
TEST_P(PairMethods, ADarkCellStaysDark) {
    SceneMaker maker(64);
    const std::array<glm::vec3, 3> edges = {glm::vec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
    const auto lit = maker.box({0, 0, 0}, edges, maker.material(0.5f, 1.0f), 9);
    const auto dark = maker.box({1, 0, 0}, edges, maker.material(0.5f), 9);
    const Baked baked = bakeScene(maker.scene(), desc(maker.size(), 3));
    for (size_t i = 0; i < lit.size(); ++i) {
        EXPECT_GT(statistics(baked.lighting, lit[i]).min, 0.5);
        EXPECT_EQ(statistics(baked.lighting, dark[i]).max, 0.0);
    }
}

TEST_P(PairMethods, BatchesAndCachesChangeNoByte) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc bake = desc(64, 4);
    bake.cache.kind = CacheSettings::Kind::None;
    const Baked plain = bakeScene(scene, bake);
    EXPECT_EQ(plain.progress.cacheBytes, 0u);
    EXPECT_EQ(plain.progress.raysSaved, 0u);
    bake.batchMs = 2;
    const Baked inPieces = bakeScene(scene, bake);
    EXPECT_TRUE(sameBytes(plain.lighting, inPieces.lighting));
    EXPECT_EQ(plain.progress.rays, inPieces.progress.rays);
    bake.cache.kind = CacheSettings::Kind::Auto;
    const Baked cached = bakeScene(scene, bake);
    EXPECT_TRUE(sameBytes(plain.lighting, cached.lighting));
    EXPECT_GT(cached.progress.cacheBytes, 0u);
    EXPECT_LE(cached.progress.rays, plain.progress.rays);
    if (GetParam().method == Method::Adaptive) return; // its senders change from bounce to bounce
    EXPECT_EQ(cached.progress.rays + cached.progress.raysSaved, plain.progress.rays);
    EXPECT_EQ(cached.progress.cachedShare, 1.0);
}

// Undersampling by windows of one texel is the pure method, but for the order in which it adds.
TEST(PairMethods, WindowsOfOneTexelArePure) {
    const Scene scene = generateScene("cornell_geom");
    const Baked pure = bakeScene(scene, {.size = 48, .passes = 2});
    for (const Method method : {Method::Static, Method::MonteCarlo, Method::Mipmapped}) {
        const Baked other =
            bakeScene(scene, {.size = 48, .passes = 2, .method = method, .pairs = {.window = 1}});
        EXPECT_LT(relativeError(other.lighting, pure.lighting), 1e-5) << methodName(method);
    }
}

// Where nothing may be merged, adaptive subdivision is pure, too.
TEST(PairMethods, AThresholdOfZeroIsPure) {
    const Scene scene = generateScene("cornell_geom");
    const Baked pure = bakeScene(scene, {.size = 48, .passes = 2});
    const Baked other =
        bakeScene(scene, {.size = 48, .passes = 2, .method = Method::Adaptive, .pairs = {.threshold = 0}});
    EXPECT_LT(relativeError(other.lighting, pure.lighting), 1e-5);
}

TEST(PairMethods, AThresholdThatFallsEndsNearerToPure) {
    const Scene scene = generateScene("cornell_geom");
    const auto bake = [&](Method method, double ramp) {
        return bakeScene(
            scene,
            {.size = 64, .passes = 4, .method = method, .pairs = {.threshold = 0.2, .thresholdRamp = ramp}});
    };
    const Baked pure = bake(Method::Pure, 1), steady = bake(Method::Adaptive, 1),
                falls = bake(Method::Adaptive, 0.25);
    EXPECT_LT(relativeError(falls.lighting, pure.lighting),
              0.7 * relativeError(steady.lighting, pure.lighting));
}

// What does not fit is traced in every bounce, and nothing else changes.
TEST(VisibilityCache, KeepsWhatFits) {
    const Scene scene = generateScene("cornell_geom");
    const auto bake = [&](CacheSettings cache, bool rtrad = false) {
        const auto baker = makeBaker(scene, {.size = 64, .passes = 4, .cache = cache, .rtrad = rtrad});
        while (!baker->solver().done())
            baker->solver().step();
        return std::pair(baker->lightmap({.quantity = Quantity::Radiance}), baker->solver().progress());
    };
    using Kind = CacheSettings::Kind;
    const auto [plain, none] = bake({.kind = Kind::None});
    const auto [some, part] = bake({.kind = Kind::Bits, .bytes = 3 * kSlot + 1});
    EXPECT_TRUE(sameBytes(plain, some));
    EXPECT_EQ(part.cacheBytes, 3 * kSlot);
    EXPECT_GT(part.cachedShare, 0.1);
    EXPECT_LT(part.cachedShare, 0.9);
    EXPECT_LT(part.rays, none.rays);
    EXPECT_EQ(part.rays + part.raysSaved, none.rays);
    const auto [tiny, nothing] = bake({.kind = Kind::Bits, .bytes = 1024});
    EXPECT_TRUE(sameBytes(plain, tiny));
    EXPECT_EQ(nothing.cacheBytes, 0u);
    EXPECT_EQ(nothing.rays, none.rays);

    // The preset's pairs have bits from either end.
    const auto [presetPlain, presetNone] = bake({.kind = Kind::None}, true);
    const auto [presetKept, presetAll] = bake({}, true);
    EXPECT_TRUE(sameBytes(presetPlain, presetKept));
    EXPECT_EQ(presetAll.cachedShare, 1.0);
    EXPECT_EQ(presetAll.rays + presetAll.raysSaved, presetNone.rays);
}

// There are more super-blocks than a batch's table has room for, so that those not kept take turns.
TEST(VisibilityCache, ALongListOfSuperBlocksIsRight) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc{.size = 96, .passes = 2, .batchMs = 45, .cache = {.kind = CacheSettings::Kind::None}};
    const Baked plain = bakeScene(scene, desc);
    desc.cache = {.kind = CacheSettings::Kind::Bits, .bytes = 7 * kSlot};
    desc.batchMs = 5;
    EXPECT_TRUE(sameBytes(plain.lighting, bakeScene(scene, desc).lighting));
}

} // namespace relume
