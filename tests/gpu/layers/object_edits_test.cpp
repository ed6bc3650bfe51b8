// Objects are moved, hidden and shown again while layers are baked, which is held against fresh bakes of what
// that leads to.
#include "assets/atlas/lightmap_atlas.h"
#include "bake/baker/move_search.h"
#include "bake/layers/layer_solver.h"
#include "bake/trace/make_tracer.h"
#include "bake/validity/step_aside.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/edited_layers.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

/// Makes the furnished room with a bulb, a spot and a panel.
Scene movingRoom(float plate = 8.0f) {
    Scene scene = furnishedRoom(plate).scene();
    scene.lights = {bulbInRoom(), spotInRoom(), panelInRoom()};
    return scene;
}

/// Follows objects that move, are hidden and shown: the bake follows `scene` when it is told.
class Moving : public EditedLayers {
public:
    explicit Moving(Scene start, const BakeDesc& desc = kEditedDesc)
        : EditedLayers(std::move(start), desc), atlas_(buildAtlas(scene, desc.size)) {
        finish();
    }

    /// Tells whether the solver could follow the scene as it is now.
    bool follow() {
        rest();
        return apply() == Applied::Now;
    }
    Applied apply() { return baker_->apply({.scene = editsOf(scene), .mix = {}, .atlas = &atlas_}); }
    void put(size_t first, size_t last, const glm::mat4& transform) {
        for (size_t i = first; i < last; ++i)
            scene.instances[i].transform = transform * scene.instances[i].transform;
    }
    void hide(size_t first, size_t last, bool hidden) {
        for (size_t i = first; i < last; ++i)
            scene.instances[i].hidden = hidden;
    }
    Light4 light() { return solver().light(); }

private:
    LightmapAtlas atlas_;
};

/// Follows the scene to its end and compares it with a fresh bake. Returns the share of a fresh bake's rays
/// that it took.
double followed(Moving& bake, const BakeDesc& desc = kEditedDesc) {
    const uint64_t before = bake.rays();
    EXPECT_TRUE(bake.follow());
    bake.finish();
    const uint64_t rays = bake.rays() - before;
    Moving fresh(bake.scene, desc);
    expectFresh(bake, fresh);
    return static_cast<double>(rays) / static_cast<double>(fresh.rays());
}

glm::mat4 by(glm::vec3 offset) {
    return glm::translate(glm::mat4(1.0f), offset);
}

glm::mat4 turned(float angle, glm::vec3 about, glm::vec3 axis) {
    return by(about) * glm::rotate(glm::mat4(1.0f), angle, axis) * by(-about);
}

/// Runs with the host's tracer and gather, and with every tracer of the device and the device's gather.
class ObjectEdits : public testing::TestWithParam<int> {
protected:
    static BakeDesc desc() {
        BakeDesc desc = kEditedDesc;
        const std::vector<TracerKind> tracers = tracersOfTestDevice();
        if (GetParam() == 0) return desc;
        desc.tracer = tracers[static_cast<size_t>(GetParam() - 1) % tracers.size()];
        desc.deviceGather = true;
        return desc;
    }
    /// Returns the largest share of a fresh bake's rays that is allowed. Batches of a device's gather take in
    /// whole runs of chunks, which is all of so small a lightmap.
    static double few(double share) {
        return GetParam() == 0 && testDevice().info().software() ? share : 1.0;
    }
};

} // namespace

TEST_P(ObjectEdits, AMovedObjectIsAFreshBake) {
    Moving bake(movingRoom(), desc());
    bake.put(kShelf, kBlock, by({-0.3f, 0.4f, 0.2f}));
    EXPECT_LT(followed(bake, desc()), few(0.7));
}

TEST_P(ObjectEdits, ASmallObjectThatMovesTakesFewRays) {
    Moving bake(movingRoom(), desc());
    bake.put(kBlock, kBlockEnd, by({0.02f, 0.05f, 0.01f}));
    EXPECT_LT(followed(bake, desc()), few(0.4));
}

TEST_P(ObjectEdits, AMovedObjectIsSeenInAllLightsAtOnce) {
    BakeDesc live = desc();
    live.live = true;
    live.smooth = false; // each layer has a width of its own
    Moving bake(movingRoom(), live);
    bake.put(kBlock, kBlockEnd, by({0.4f, -0.3f, 0.2f}));
    ASSERT_TRUE(bake.follow());
    EXPECT_FALSE(bake.solver().current());
    while (!bake.solver().current())
        bake.solver().step();
    const auto follows = [&] {
        const auto& layers = bake.solver().layers();
        return std::any_of(layers.begin(), layers.end(), [](const auto& layer) { return layer->has(); });
    };
    EXPECT_FALSE(follows());
    const Light4 atOnce = bake.light();
    Light4 soon;
    for (; !follows(); bake.solver().step())
        soon = bake.light();
    bake.finish();
    const Light4 after = bake.light(), fresh = Moving(bake.scene, live).light();
    EXPECT_TRUE(sameBytes(after, fresh));
    EXPECT_LT(distance(atOnce, after), 0.012)
        << "of the first rays to lights, which sample texels, too, and count only until there are others";
    EXPECT_LT(distance(soon, after), 1e-3) << "of the same rays to lights and links";
}

// The light, too, is seen in its new place, before any layer is there.
TEST(ObjectEdits, ALampThatIsMovedAtOnceWithAnObjectIsSeenInAllLights) {
    BakeDesc live = kEditedDesc;
    live.live = true;
    Moving bake(movingRoom(), live);
    bake.put(kBlock, kBlockEnd, by({0.4f, -0.3f, 0.2f}));
    bake.scene.lights[0].transform = by({0.4f, 0.5f, 1.2f});
    ASSERT_TRUE(bake.follow());
    while (!bake.solver().current())
        bake.solver().step();
    const auto& layers = bake.solver().layers();
    EXPECT_TRUE(std::none_of(layers.begin(), layers.end(), [](const auto& layer) { return layer->has(); }));
    const Light4 atOnce = bake.light();
    bake.finish();
    EXPECT_LT(distance(atOnce, bake.light()), 0.03);
    EXPECT_TRUE(sameBytes(bake.light(), Moving(bake.scene, live).light()));
}

// The sum of all lights takes links of a few sample passes; those of all the others follow once it is seen.
TEST_P(ObjectEdits, ADraggedObjectIsSeenBeforeAllLinksHaveFollowed) {
    BakeDesc live = desc();
    live.live = true;
    live.samples = 256;
    Moving bake(movingRoom(), live);
    for (int k = 0; k < 3; ++k) {
        bake.put(kBlock, kBlockEnd, by({0.1f, -0.1f, 0.05f}));
        ASSERT_TRUE(bake.follow());
        while (!bake.solver().current())
            bake.solver().step();
        for (int i = 0; i < k; ++i) // some have followed when it is moved on
            bake.solver().step();
        EXPECT_TRUE(bake.solver().atRest());
    }
    bake.finish();
    const Light4 after = bake.light(), fresh = Moving(bake.scene, live).light();
    for (size_t i = 0; i < after.size(); ++i)
        ASSERT_EQ(after[i], fresh[i]) << "patch " << i;
}

// Each place is seen, however soon the next one comes, and what is shown never goes back to former ones.
TEST_P(ObjectEdits, AnObjectThatIsDraggedOnAndOnIsSeen) {
    BakeDesc live = desc();
    live.live = true;
    live.batchMs = 1.0;
    Moving bake(movingRoom(), live);
    const Light4 before = bake.light();
    bake.put(kBlock, kBlockEnd, by({0.5f, -0.5f, 0.2f}));
    for (int k = 0; k < 6; ++k) {
        bake.put(kBlock, kBlockEnd, by({0.02f, -0.02f, 0.01f}));
        ASSERT_TRUE(bake.follow());
        EXPECT_FALSE(bake.solver().current());
        const Light4 shown = bake.light();
        for (bool waits = true; waits; waits = !bake.solver().atRest()) {
            bake.solver().step();
            EXPECT_TRUE(k == 0 || distance(bake.light(), before) > 0.1) << "frame of place " << k;
        }
        EXPECT_TRUE(bake.solver().current());
        EXPECT_GT(distance(bake.light(), shown), 1e-3) << "nothing new of place " << k;
        for (const auto& layer : bake.solver().layers())
            EXPECT_TRUE(layer->before && layer->before->has()) << "those of places in between take memory";
    }
    bake.scene.lights[0].transform = by({0.4f, 0.5f, 1.2f});
    ASSERT_EQ(bake.apply(), Applied::Now);
    while (!bake.solver().done()) {
        bake.solver().step();
        EXPECT_GT(distance(bake.light(), before), 0.1);
    }
    const Light4 after = bake.light(), fresh = Moving(bake.scene, live).light();
    for (size_t i = 0; i < after.size(); ++i)
        ASSERT_EQ(after[i], fresh[i]) << "patch " << i;
}

TEST_P(ObjectEdits, ATurnedAndScaledObjectIsAFreshBake) {
    Moving bake(movingRoom(), desc());
    bake.put(kBlock, kBlockEnd,
             turned(0.5f, {0.35f, 1.35f, 0.2f}, kZ) * by({0.0f, 0.0f, 0.1f}) *
                 glm::scale(glm::mat4(1.0f), {1.1f, 0.9f, 1.3f}));
    followed(bake, desc());
}

TEST_P(ObjectEdits, AHiddenObjectIsAFreshBakeAndSoIsOneShownAgain) {
    Moving bake(movingRoom(), desc());
    const std::vector<FloatImage> first = bake.images();
    bake.hide(kBlock, kBlockEnd, true);
    EXPECT_LT(followed(bake, desc()), few(0.5));
    bake.hide(kBlock, kBlockEnd, false);
    bake.put(kBlock, kBlockEnd, by({0.4f, 0.1f, 0.0f}));
    followed(bake, desc());
}

TEST_P(ObjectEdits, ThereAndBackAreTheFirstBytes) {
    Moving bake(movingRoom(), desc());
    const Light4 first = bake.light();
    const Scene before = bake.scene;
    for (const glm::vec3& offset : {glm::vec3(0.2f, 0.0f, 0.3f), glm::vec3(0.5f, -0.6f, 0.1f)}) {
        bake.put(kBlock, kBlockEnd, by(offset));
        ASSERT_TRUE(bake.follow());
        for (int i = 0; i < 9; ++i)
            bake.solver().step();
    }
    bake.scene = before;
    ASSERT_TRUE(bake.follow());
    bake.finish();
    EXPECT_EQ(bake.light(), first);
    // Links are back as well, since what is made of them is.
    bake.scene.lights[0].transform = by({0.7f, 0.5f, 1.2f});
    followed(bake, desc());
}

TEST_P(ObjectEdits, AnObjectThatShinesIsAFreshBake) {
    Moving bake(movingRoom(), desc());
    bake.put(kPlate, kPlate + 1, by({0.3f, 0.2f, -0.4f}));
    followed(bake, desc());
    bake.hide(kPlate, kPlate + 1, true);
    followed(bake, desc());
    bake.hide(kPlate, kPlate + 1, false);
    followed(bake, desc());
}

TEST_P(ObjectEdits, AnObjectMovedIntoALampIsAFreshBake) {
    Moving bake(movingRoom(), desc());
    bake.put(kBlock, kBlockEnd, by({1.15f, 0.15f, 1.3f})); // around the bulb
    followed(bake, desc());
    EXPECT_EQ(bake.solver().layers()[1]->light, 0.0) << "its sides are backs, which let nothing out";
    bake.put(kBlock, kBlockEnd, by({-0.6f, -0.2f, -0.8f}));
    followed(bake, desc());
    EXPECT_GT(bake.solver().layers()[1]->light, 0.0);
}

TEST_P(ObjectEdits, AnObjectBehindAWallIsAFreshBake) {
    Moving bake(movingRoom(), desc());
    bake.put(kBlock, kBlockEnd, by({0.0f, 0.0f, -2.0f})); // below the floor
    followed(bake, desc());
    bake.put(kBlock, kBlockEnd, by({0.3f, 0.1f, -0.2f}));
    EXPECT_LT(followed(bake, desc()), few(0.25))
        << "its own rays, and what looks towards it through the wall";
}

/// Makes a room with a bulb, a block, and a wall that is thinner than a texel and stands on the middles of
/// the floor's.
Scene walledRoom() {
    SceneMaker maker(kRoomSize);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.6f), 12);
    maker.box({0.36f, 0.3f, -0.1f}, {1.4f * kY, 0.12f * kX, 1.3f * kZ}, maker.material(0.5f), 6);
    maker.box({1.3f, 1.2f, 0.4f}, {0.3f * kY, 0.3f * kX, 0.3f * kZ}, maker.material(0.5f), 4);
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1.0f, 1.0f, 1.5f}, 3.0f, "Bulb"));
    return scene;
}

TEST_P(ObjectEdits, PatchesThatStepAsideAreAFreshBake) {
    constexpr size_t kWall = 6, kFarBlock = 12, kEnd = 18;
    Moving bake(walledRoom(), desc());
    const auto aside = [&] { return bake.baker().patches().aside.size(); };
    const size_t first = aside();
    EXPECT_GE(first, 5u);
    bake.put(kFarBlock, kEnd, by({-0.3f, 0.1f, 0.0f})); // far from those that have stepped aside
    followed(bake, desc());
    EXPECT_EQ(aside(), first);
    // It stands where some have stepped to; they step to the other side of the wall now, and back.
    const std::vector<OwnPoint> points = pointsAside(bake.baker().patches());
    bake.put(kFarBlock, kEnd, by({-0.945f, -0.7f, -0.45f}));
    followed(bake, desc());
    EXPECT_NE(pointsAside(bake.baker().patches()), points);
    bake.put(kFarBlock, kEnd, by({0.945f, 0.7f, 0.45f}));
    followed(bake, desc());
    bake.put(kWall, kFarBlock, by({0.03f, 0.0f, 0.0f})); // they step elsewhere, or less far is seen
    followed(bake, desc());
    bake.hide(kWall, kFarBlock, true);
    followed(bake, desc());
    EXPECT_LT(aside(), first);
    bake.hide(kWall, kFarBlock, false);
    bake.put(kWall, kFarBlock, by({0.5f, 0.1f, 0.0f}));
    followed(bake, desc());
    EXPECT_GE(aside(), 3u);
}

// Moves keep what they look with, and the memory for it is that of the plan.
TEST_P(ObjectEdits, WhatMovesKeepIsPlannedAndKept) {
    const bool software = testDevice().info().software(); // its memory is the host's
    const auto kept = [&] {
        constexpr std::array kNames = {"links from inside",     "links to trace",   "links that were traced",
                                       "changed patches",       "places in texels", "seen places",
                                       "patches that ask",      "places near by",   "links that come back",
                                       "patches that are asked"};
        uint64_t bytes = 0;
        for (const auto& [key, own] : testDevice().ledger().entries())
            if ((software || !key.ofHost) &&
                std::find(kNames.begin(), kNames.end(), key.name) != kNames.end())
                bytes += own;
        return bytes;
    };
    const uint64_t before = kept();
    Moving bake(walledRoom(), desc());
    EXPECT_EQ(kept(), before) << "a bake itself leaves nothing of its searches";
    const auto move = [&](glm::vec3 offset) {
        bake.put(12, 18, by(offset));
        EXPECT_TRUE(bake.follow());
        bake.finish();
        return kept() - before;
    };
    const uint64_t first = move({-0.945f, -0.7f, -0.45f});
    EXPECT_GT(first, 0u);
    EXPECT_LE(first, MoveSearch::bytes(bake.baker().patches().chunkCount(), software));
    EXPECT_EQ(move({0.945f, 0.7f, 0.45f}), first);
}

INSTANTIATE_TEST_SUITE_P(Tracers, ObjectEdits, testing::Range(0, 4));

// The object is half in the floor and half out of it, and texels of both change whether they lie inside
// something.
TEST(ObjectEdits, TexelsInsideSomethingAreFoundAnew) {
    SceneMaker maker(kRoomSize);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.6f), 12);
    maker.box({0.5f, 0.5f, 0.3f}, {0.8f * kY, 0.8f * kX, 0.6f * kZ}, maker.material(0.5f), 8);
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1.0f, 1.0f, 1.5f}, 3.0f, "Bulb"));
    Moving bake(scene);
    EXPECT_EQ(bake.baker().invalidPatches(), 0u);
    bake.put(6, 12, by({0.1f, 0.2f, -0.6f}));
    followed(bake);
    EXPECT_GT(bake.baker().invalidPatches(), 10u);
    bake.put(6, 12, by({0.0f, 0.0f, 0.5f}));
    followed(bake);
    EXPECT_EQ(bake.baker().invalidPatches(), 0u);
}

// The sky and the sun come from all around; a wall that leaves makes the scene another size.
TEST(ObjectEdits, UnderSkyAndSunAreAFreshBake) {
    SceneMaker maker(32);
    maker.quad({-1, -1, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(16));
    maker.quad({0, -1, 0}, 1.0f * kZ, 2.0f * kY, maker.material(0.5f), glm::uvec2(8));
    maker.quad({-0.5f, -0.5f, 0.3f}, 0.3f * kX, 0.3f * kY, maker.material(0.5f), glm::uvec2(4));
    Scene scene = maker.scene();
    scene.sky.radiance = glm::vec3(2.0f);
    Light sun = lightAt(LightType::Directional, {}, 5.0f, "Sun");
    sun.transform = glm::rotate(glm::mat4(1.0f), 0.4f, kY);
    sun.angle = 0.02f;
    scene.lights.push_back(sun);
    BakeDesc desc = kEditedDesc;
    desc.size = 32;
    Moving bake(scene, desc);
    bake.put(2, 3, by({-0.1f, 0.3f, 0.1f}));
    EXPECT_LT(followed(bake, desc), 0.9);
    bake.put(1, 2, by({1.5f, 0.3f, 0.1f}));
    followed(bake, desc);
}

TEST(ObjectEdits, MasksAndBlockersMoveAsWell) {
    SceneMaker maker(kRoomSize);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.6f), 12);
    Material leaf;
    leaf.metallic = 0.0f;
    leaf.alphaMode = AlphaMode::Mask;
    leaf.baseColorTexture.texture = maker.alphaTexture(2, 2, {255, 0, 0, 255});
    maker.quad({0.7f, 0.7f, 1.0f}, 0.6f * kX, 0.6f * kY, maker.material(leaf), glm::uvec2(8));
    maker.blocker({0.2f, 0.2f, 0.6f}, 0.4f * kX, 0.4f * kY, maker.material(0.5f));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1.0f, 1.0f, 1.8f}, 3.0f, "Bulb"));
    Moving bake(scene);
    bake.put(6, 8, turned(0.3f, {1, 1, 1}, kX));
    followed(bake);
    bake.put(7, 8, by({0.5f, 0.5f, 0.1f}));
    followed(bake);
    bake.hide(6, 8, true);
    followed(bake);
}

// Each edit comes before the one before was followed to its end, and analytic lights move as well.
TEST(ObjectEdits, DraggingEndsAsAFreshBake) {
    BakeDesc desc = kEditedDesc;
    desc.batchMs = 1.0;
    desc.live = true;
    Moving bake(movingRoom(), desc);
    for (int i = 0; i < 12; ++i) {
        bake.put(kBlock, kBlockEnd, by({0.03f, -0.02f, 0.01f}));
        if (i % 3 == 0) bake.scene.lights[0].transform = by({0.3f + 0.04f * i, 0.5f, 1.2f});
        ASSERT_TRUE(bake.follow());
        for (int steps = 0; steps < 5 * i; ++steps)
            bake.solver().step();
        EXPECT_TRUE(bake.solver().liveLight().complete) << "what was shown stays until there is more";
    }
    followed(bake, desc);
}

// Where links of later sample passes are not kept, they are traced again as ever.
TEST(ObjectEdits, LinksBeyondTheMemoryAreTracedWhereObjectsAre) {
    BakeDesc desc = kEditedDesc;
    desc.samples = 64;
    desc.cache.bytes = 2 * 16 * sizeof(uint32_t) * 4000;
    Moving bake(movingRoom(), desc);
    bake.put(kShelf, kBlock, by({-0.3f, 0.4f, 0.2f}));
    followed(bake, desc);
}

TEST(ObjectEdits, WhatCannotBeFollowedIsToldAndChangesNothing) {
    Scene scene = movingRoom();
    scene.instances[kShelf].hidden = true;
    Moving bake(scene);
    const Light4 first = bake.light();
    bake.hide(kShelf, kBlock, false);
    EXPECT_FALSE(bake.follow()) << "it has no patches";
    bake.hide(kShelf, kBlock, true);
    bake.put(kBlock, kBlock + 1, glm::scale(glm::mat4(1.0f), glm::vec3(0.0f)));
    EXPECT_FALSE(bake.follow()) << "its triangles have no area";
    bake.scene = scene;
    EXPECT_TRUE(bake.follow());
    bake.finish();
    EXPECT_EQ(bake.light(), first);
}

} // namespace relume
