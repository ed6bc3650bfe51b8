// A start of the viewer's bake is compared with the bake under way, which decides what is made anew.
#include "app/live/bake_meter.h"
#include "app/live/bake_recipe.h"
#include "app/live/seen_chunks.h"

#include <gtest/gtest.h>

#include <vector>

namespace relume {
namespace {

BakeSettings layeredSettings() {
    BakeSettings settings;
    settings.solver.method = Method::Hybrid;
    settings.solver.layers.on = true;
    return settings;
}

using ChangeRecipe = void (*)(BakeRecipe&);

TEST(BakeRecipe, ABakeableOneHasLayersWhereItsMethodCan) {
    constexpr double kBatchMs = 3.0;
    const BakeSettings layered = bakeable(layeredSettings(), kBatchMs);
    EXPECT_TRUE(layered.solver.layers.on && layered.solver.layers.optional && layered.solver.live);
    EXPECT_EQ(layered.solver.batchMs, kBatchMs);
    for (void (*const change)(BakeSettings&) :
         {+[](BakeSettings& s) { s.solver.method = Method::Directional; },
          +[](BakeSettings& s) { s.solver.links.footprint = true; },
          +[](BakeSettings& s) { s.solver.links.indirectScale = 2; },
          +[](BakeSettings& s) { s.solver.links.directions = DirectionSet::Lec; },
          +[](BakeSettings& s) { s.solver.transport.rtrad = true; },
          +[](BakeSettings& s) { s.solver.layers.on = false; }}) {
        BakeSettings settings = layeredSettings();
        change(settings);
        EXPECT_FALSE(bakeable(settings, kBatchMs).solver.layers.on);
    }
}

TEST(BakeRecipe, WhatDoesNotChangeABakesLightIsAnEditAtMost) {
    const BakeRecipe baked{.surfaces = 3, .settings = bakeable(layeredSettings(), 1.0)};
    for (const ChangeRecipe change :
         {+[](BakeRecipe&) {}, +[](BakeRecipe& r) { r.settings.solver.batchMs = 9.0; },
          +[](BakeRecipe& r) { r.settings.solver.layers.on = false; }}) {
        BakeRecipe wanted = baked;
        change(wanted);
        EXPECT_TRUE(differOnlyInEdits(baked, wanted));
    }
}

TEST(BakeRecipe, WhatDoesIsMore) {
    const BakeRecipe baked{.surfaces = 3, .settings = bakeable(layeredSettings(), 1.0)};
    for (const ChangeRecipe change :
         {+[](BakeRecipe& r) { r.surfaces = 4; }, +[](BakeRecipe& r) { r.rings = 2; },
          +[](BakeRecipe& r) { r.settings.size = 64; },
          +[](BakeRecipe& r) { r.settings.tracer = TracerKind::Bvh; },
          +[](BakeRecipe& r) { r.settings.solver.error = 0.5; },
          +[](BakeRecipe& r) { r.settings.solver.cache.kind = CacheSettings::Kind::None; },
          +[](BakeRecipe& r) { r.settings.solver.cache.bytes = 1; }}) {
        BakeRecipe wanted = baked;
        change(wanted);
        EXPECT_FALSE(differOnlyInEdits(baked, wanted));
    }
}

TEST(BakeRecipe, PatchesServeForAnotherSolver) {
    const BakeSettings settings = layeredSettings();
    BakeSettings other = settings;
    other.solver.method = Method::Static;
    other.solver.error = 0.5;
    EXPECT_TRUE(samePatches(settings, other));
    for (void (*const change)(BakeSettings&) :
         {+[](BakeSettings& s) { s.size = 64; }, +[](BakeSettings& s) { s.conservative = true; },
          +[](BakeSettings& s) { s.tracer = TracerKind::Bvh; }, +[](BakeSettings& s) { s.voxels.ratio = 2; },
          +[](BakeSettings& s) { s.solver.transport.reflectivity = 0.5f; }}) {
        other = settings;
        change(other);
        EXPECT_FALSE(samePatches(settings, other));
    }
}

// The lightmap is 12 texels wide: two tiles in a row, of which the second one is half as wide.
TEST(SeenChunks, AreThoseWithAPatchInASeenTile) {
    TraceScene scene;
    scene.size = 12;
    scene.texelToPatch.assign(size_t{12} * 12, shader::kNoPatch);
    scene.patches.resize(size_t{3} * shader::kChunk);
    scene.texelToPatch[0] = 5;                            // in tile 0
    scene.texelToPatch[11] = shader::kChunk;              // in tile 1
    scene.texelToPatch[12 * 11] = 2 * shader::kChunk + 1; // in tile 2
    EXPECT_EQ(seenChunks(scene, {}), (std::vector<uint8_t>{0, 0, 0}));
    const std::vector<uint32_t> first = {0}, second = {1}, others = {2, 3};
    EXPECT_EQ(seenChunks(scene, first), (std::vector<uint8_t>{1, 0, 0}));
    EXPECT_EQ(seenChunks(scene, second), (std::vector<uint8_t>{0, 1, 0}));
    EXPECT_EQ(seenChunks(scene, others), (std::vector<uint8_t>{0, 0, 1}));
}

TEST(ConvergenceCurve, TakesPointsWhoseErrorIsKnownAndNew) {
    std::vector<ConvergencePoint> history;
    addPoint(history, {1.0, 1.0}, 8);
    EXPECT_TRUE(history.empty());
    addPoint(history, {2.0, 0.5}, 8);
    addPoint(history, {3.0, 0.5}, 8);
    EXPECT_EQ(history.size(), 1u);
}

TEST(ConvergenceCurve, DropsEveryOtherPointWhereTheyAreMany) {
    std::vector<ConvergencePoint> history;
    for (int i = 0; i < 5; ++i)
        addPoint(history, {1.0 * i, 0.5 - 0.1 * i}, 4);
    ASSERT_EQ(history.size(), 3u);
    EXPECT_EQ(history[0].seconds, 0.0);
    EXPECT_EQ(history[1].seconds, 2.0);
    EXPECT_EQ(history[2].seconds, 4.0);
}

} // namespace
} // namespace relume
