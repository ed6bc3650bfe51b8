// This tests the direct light of layers, whose rays go where neighbours see different shares of a light.
#include "assets/generate/generate.h"
#include "assets/images/metrics.h"
#include "bake/surface/tile_parts.h"
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace relume {
namespace {

constexpr uint32_t kPoints = 1024; // on the light, per patch
constexpr BakeDesc kDirect{.passes = 1, .method = Method::Hybrid, .samples = kPoints, .layers = true};

/// Makes a floor of 2 m below a panel, and a plate of a quarter of its edge between them.
Scene shaded(LightType type = LightType::Rectangle) {
    SceneMaker maker(64);
    maker.quad({0, 0, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(40));
    maker.quad({0.75f, 0.75f, 0.4f}, 0.5f * kX, 0.5f * kY, maker.material(0.5f), glm::uvec2(8));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(type, {1.0f, 1.0f, 1.5f}, 20.0f, "Panel"));
    scene.lights.back().size = {0.3f, 0.3f};
    scene.lights.back().radius = 0.15f;
    return scene;
}

/// Returns what would be found if every patch took every ray.
FloatImage everyRay(const Scene& scene) {
    BakeDesc all = kDirect;
    all.layers = false;
    return bakeScene(scene, all).lighting;
}

} // namespace

// Every patch would take kPoints rays; the penumbra is an eighth of the floor.
TEST(Penumbra, TakesTheRays) {
    const Scene scene = shaded();
    Layered bake(scene, kDirect);
    bake.finish();
    uint64_t patches = 0;
    for (const shader::Patch& patch : bake.patches().scene.patches)
        patches += (patch.flags & shader::kPatchSends) != 0;
    const double perPatch = static_cast<double>(bake.progress().rays) / static_cast<double>(patches);
    EXPECT_LT(perPatch, 0.6 * kPoints);
    EXPECT_GT(perPatch, 0.15 * kPoints);
    EXPECT_LE(relativeError(bake.image(), everyRay(scene)), 2e-3);
    EXPECT_LE(bake.progress().error, 4e-3); // the rays sample the texels, too
}

// With four points per sample pass, some of which lie below the horizon of what is turned away, and few
// sample passes outside penumbrae: neither is to show in the mean, however few points tell what is seen.
TEST(Penumbra, FewPointsAreRightInTheMean) {
    const Scene scene = generateScene("cornell_statue");
    BakeDesc desc = kDirect;
    desc.size = 64;
    const FloatImage layers = bakeScene(scene, desc).lighting;
    desc.layers = false;
    desc.samples = 4 * kPoints;
    const FloatImage all = bakeScene(scene, desc).lighting;
    const NamedImage few{layers, "layers"}, every{all, "every ray"};
    const ImagePair pair(few, every);
    const Metrics metrics = pair.measure();
    EXPECT_NEAR(metrics.bias, 0.0, 5e-4 * metrics.meanB);
    EXPECT_NEAR(pair.darkBias(), 0.0, 0.02) << "a ratio of the sums of four points is 0.13 too dark";
}

// Layers take four points of a light per sample pass, plain bakes 16. They are the same points, so the layer
// is to be no noisier: of mesh lights, near ones too, and of analytic ones.
TEST(Penumbra, FewPointsPerSamplePassAreNoNoisier) {
    for (const Scene& scene : {generateScene("cornell_statue"), shaded()}) {
        BakeDesc desc = kDirect;
        desc.size = 64;
        desc.samples = 256;
        const FloatImage layers = bakeScene(scene, desc).lighting;
        desc.layers = false;
        const FloatImage plain = bakeScene(scene, desc).lighting;
        desc.samples = 8192;
        const FloatImage all = bakeScene(scene, desc).lighting;
        EXPECT_LT(relativeError(layers, all), 1.25 * relativeError(plain, all)) << scene.path;
    }
}

// A lamp of many polygons, of which each sample pass picks some: what all of them bring without shadows is
// known, so that rays go to its penumbra, and the mean is right.
TEST(Penumbra, IsFoundOfALightWithManyPolygons) {
    SceneMaker maker(64);
    maker.quad({0, 0, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(40));
    maker.quad({0.75f, 0.75f, 0.4f}, 0.5f * kX, 0.5f * kY, maker.material(0.5f), glm::uvec2(8));
    maker.disc({1.0f, 1.0f, 1.5f}, 0.2f * kX, -0.2f * kY, maker.material(0.0f, 20.0f), 6);
    const Scene scene = maker.scene();
    Layered bake(scene, kDirect);
    bake.finish();
    ASSERT_EQ(bake.solver().layers().size(), 1u);
    EXPECT_LT(bake.solver().layers()[0]->directShare(), 0.7);
    BakeDesc desc = kDirect;
    desc.layers = false;
    desc.samples = kPoints; // a quarter of them on each polygon
    const FloatImage every = bakeScene(scene, desc).lighting;
    EXPECT_LE(relativeError(bake.image(), every), 5e-3);
}

// Where no share is known each sample counts, and nothing may be left out.
TEST(Penumbra, IsEverywhereWhereTheWholeLightIsUnknown) {
    const Scene scene = shaded(LightType::Disc);
    Layered bake(scene, kDirect);
    bake.finish();
    EXPECT_LE(relativeError(bake.image(), everyRay(scene)), 2e-3);
    EXPECT_DOUBLE_EQ(bake.solver().layers()[0]->directShare(), 1.0);
}

// Going step by step leads as far as going at once, but for rounding.
TEST(Penumbra, IsThatOfTheFirstSamplePass) {
    const Scene scene = shaded();
    Layered few(scene, {.passes = 1, .method = Method::Hybrid, .samples = 8, .layers = true}),
        many(scene, kDirect);
    few.finish();
    many.finish();
    EXPECT_EQ(few.solver().layers()[0]->penumbra, many.solver().layers()[0]->penumbra);
    EXPECT_EQ(few.solver().layers()[0]->directSamplePasses, 2u);
}

TEST(Penumbra, PartsAreThoseOfOneTileAndObject) {
    Layered bake(room());
    const PatchSet& set = bake.patches();
    const TileParts parts = makeTileParts(set);
    std::vector<std::set<std::pair<uint32_t, uint32_t>>> tiles(parts.count); // and objects
    for (size_t i = 0; i < set.scene.patches.size(); ++i) {
        const uint32_t texel = shader::patchTexel(set.scene.patches[i].flags), size = set.scene.size;
        tiles[parts.ofPatch[i]].insert({texel / size / 8 * size + texel % size / 8, set.instance[i]});
        const auto own = parts.of(static_cast<uint32_t>(i / shader::kChunk));
        EXPECT_NE(std::find(own.begin(), own.end(), parts.ofPatch[i]), own.end());
    }
    for (const auto& part : tiles)
        EXPECT_EQ(part.size(), 1u);
}

} // namespace relume
