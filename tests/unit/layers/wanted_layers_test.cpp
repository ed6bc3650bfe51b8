#include "bake/layers/wanted_layers.h"

#include "tests/unit/no_device.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr uint64_t kRoomForAll = 64;
constexpr uint64_t kRoomForTwo = 3; // and a spare one: "lamp 0" and "rest"

void addPointLight(Scene& scene) {
    Light lamp;
    lamp.name = "lamp " + std::to_string(scene.lights.size());
    lamp.transform[3].x = static_cast<float>(scene.lights.size());
    scene.lights.push_back(lamp);
}

Scene sceneOfLamps(uint32_t lamps) {
    Scene scene;
    for (uint32_t i = 0; i < lamps; ++i)
        addPointLight(scene);
    return scene;
}

LightKey keyOf(uint32_t lamp) {
    return {LightKey::Kind::Lamp, lamp, 0};
}

LightMix muted(std::vector<uint32_t> lamps) {
    LightMix mix;
    for (const uint32_t lamp : lamps)
        mix.muted.push_back(keyOf(lamp));
    return mix;
}

std::vector<WantedLayer> wantedOf(const Scene& scene, uint64_t room, const LightMix& mix = {}) {
    return wantedLayers(scene, mix, room, {.surfaces = 1, .objects = 1});
}

WantedLayer onlyOf(const Scene& scene, const LightMix& mix = {}) {
    std::vector<WantedLayer> wanted = wantedOf(scene, kRoomForAll, mix);
    EXPECT_EQ(wanted.size(), 1u);
    return wanted.front();
}

std::unique_ptr<Layer> layerOf(const WantedLayer& wanted) {
    auto layer = std::make_unique<Layer>();
    layer->cacheKey = wanted.cacheKey;
    layer->source = wanted.source;
    layer->members = wanted.members;
    layer->level = {2, 2};
    return layer;
}

/// Lights that an edit groups otherwise: what was baked, what is wanted now, and the plan for that.
struct Regrouping {
    explicit Regrouping(const Scene& scene, const LightMix& mix = {}) { bake(scene, mix); }

    void adopt(const Scene& scene, const LightMix& mix = {}) {
        wanted = wantedOf(scene, kRoomForTwo, mix);
        store->replace(wanted, store->take(wanted), std::vector<bool>(wanted.size(), false),
                       [](const Layer&, Layer&) {});
    }
    void bake(const Scene& scene, const LightMix& mix = {}) {
        adopt(scene, mix);
        for (const std::unique_ptr<Layer>& layer : store->layers())
            layer->level = {2, 2};
    }
    /// Returns the plan as "lamp 0, (rest) = lamp 1 + lamp 2": what is covered is in brackets, and behind it
    /// are the former layers that stand in.
    std::string planFor(const Scene& scene, const LightMix& mix = {}) {
        wanted = wantedOf(scene, kRoomForTwo, mix);
        const std::vector<std::unique_ptr<Layer>> taken = store->take(wanted);
        const StandInPlan plan = planStandIn(wanted, taken, store->layers());
        EXPECT_EQ(plan.covered.size(), wanted.size());
        std::string text;
        for (size_t i = 0; i < wanted.size(); ++i) {
            text += i > 0 ? ", " : "";
            text += plan.covered[i] ? "(" + wanted[i].source.name + ")" : wanted[i].source.name;
        }
        for (size_t i = 0; plan.regroups && i < plan.sum.size(); ++i)
            text += (i > 0 ? " + " : " = ") + plan.sum[i]->source.name;
        return text;
    }

    StoreWithoutDevice store{kRoomForAll};
    std::vector<WantedLayer> wanted;
};

TEST(WantedLayer, IsALightInItsSurroundings) {
    const std::vector<WantedLayer> wanted =
        wantedLayers(sceneOfLamps(2), {}, kRoomForAll, {.surfaces = 7, .objects = 9});
    ASSERT_EQ(wanted.size(), 2u);
    for (const WantedLayer& layer : wanted) {
        EXPECT_EQ(layer.cacheKey.surfaces, 7u);
        EXPECT_EQ(layer.cacheKey.objects, 9u);
        EXPECT_TRUE(layer.members.empty());
    }
    EXPECT_EQ(wanted[1].source.name, "lamp 1");
    EXPECT_NE(wanted[0].cacheKey, wanted[1].cacheKey);
}

TEST(WantedLayer, KnowsNothingOfColourIntensityAndName) {
    Scene scene = sceneOfLamps(1);
    const LightCacheKey cacheKey = onlyOf(scene).cacheKey;
    scene.lights[0].name = "other";
    scene.lights[0].color = glm::vec3(0.5f, 0.25f, 1.0f);
    scene.lights[0].intensity = 8.0f;
    scene.lights[0].node = 4;
    EXPECT_EQ(onlyOf(scene).cacheKey, cacheKey);
    EXPECT_EQ(onlyOf(scene).source.weight, glm::vec3(4.0f, 2.0f, 8.0f));
}

TEST(WantedLayer, KnowsPlaceAndForm) {
    const LightCacheKey cacheKey = onlyOf(sceneOfLamps(1)).cacheKey;
    const auto differs = [&](auto&& edit) {
        Scene scene = sceneOfLamps(1);
        edit(scene.lights[0]);
        return onlyOf(scene).cacheKey != cacheKey;
    };
    EXPECT_TRUE(differs([](Light& lamp) { lamp.transform[3].z = 1.0f; }));
    EXPECT_TRUE(differs([](Light& lamp) { lamp.range = 3.0f; }));
    EXPECT_TRUE(differs([](Light& lamp) { lamp.radius = 0.5f; }));
    EXPECT_TRUE(differs([](Light& lamp) { lamp.type = LightType::Disc; }));
    EXPECT_TRUE(differs([](Light& lamp) { lamp.outerConeAngle = 0.5f; }));
}

TEST(WantedLayer, WhatIsMutedHasNoWeight) {
    const std::vector<WantedLayer> wanted = wantedOf(sceneOfLamps(2), kRoomForAll, muted({1}));
    EXPECT_EQ(wanted[0].source.weight, glm::vec3(1.0f));
    EXPECT_EQ(wanted[1].source.weight, glm::vec3(0.0f));
    EXPECT_EQ(wanted[1].cacheKey, wantedOf(sceneOfLamps(2), kRoomForAll)[1].cacheKey);
}

TEST(WantedLayer, BesideASoloOthersHaveNoWeight) {
    const std::vector<WantedLayer> wanted =
        wantedOf(sceneOfLamps(2), kRoomForAll, {.muted = {}, .solo = {keyOf(1)}});
    EXPECT_EQ(wanted[0].source.weight, glm::vec3(0.0f));
    EXPECT_EQ(wanted[1].source.weight, glm::vec3(1.0f));
}

TEST(WantedLayer, OfAGroupKnowsWhoShinesInItAndHow) {
    Scene scene = sceneOfLamps(4);
    scene.lights[2].intensity = 3.0f;
    const std::vector<WantedLayer> wanted = wantedOf(scene, kRoomForTwo, muted({3}));
    ASSERT_EQ(wanted.size(), 2u);
    EXPECT_EQ(wanted[1].source.weight, glm::vec3(1.0f));
    EXPECT_EQ(wanted[1].members.size(), 3u);
    ASSERT_EQ(wanted[1].cacheKey.members.size(), 2u) << "one is muted";
    EXPECT_EQ(wanted[1].cacheKey.weights, (std::vector<glm::vec3>{glm::vec3(1.0f), glm::vec3(3.0f)}));
    EXPECT_EQ(wanted[1].members[2].weight, glm::vec3(0.0f));
}

TEST(WantedLayer, OfAGroupIsAnotherForOtherWeights) {
    Scene scene = sceneOfLamps(4);
    const LightCacheKey cacheKey = wantedOf(scene, kRoomForTwo)[1].cacheKey;
    scene.lights[2].intensity = 3.0f;
    EXPECT_NE(wantedOf(scene, kRoomForTwo)[1].cacheKey, cacheKey);
    scene.lights[2].intensity = 1.0f;
    scene.lights[2].name = "other";
    EXPECT_EQ(wantedOf(scene, kRoomForTwo)[1].cacheKey, cacheKey);
}

TEST(DarkGroup, IsOneOfWhichNothingShines) {
    const LightMix all = muted({1, 2, 3});
    const std::vector<WantedLayer> wanted = wantedOf(sceneOfLamps(4), kRoomForTwo, all);
    EXPECT_TRUE(wanted[1].isDarkGroup());
    EXPECT_EQ(wanted[1].source.weight, glm::vec3(0.0f));
    const LightMix some = muted({1, 2});
    EXPECT_FALSE(wantedOf(sceneOfLamps(4), kRoomForTwo, some)[1].isDarkGroup());
}

TEST(DarkGroup, IsNoSingleLight) {
    EXPECT_FALSE(wantedOf(sceneOfLamps(1), kRoomForAll, muted({0}))[0].isDarkGroup());
}

TEST(IsRegrouped, ALightThatIsInAGroupNow) {
    const std::unique_ptr<Layer> lamp = layerOf(wantedOf(sceneOfLamps(2), kRoomForTwo)[1]);
    EXPECT_TRUE(isRegrouped(*lamp, wantedOf(sceneOfLamps(4), kRoomForTwo)));
    lamp->cacheKey.surfaces = 5;
    lamp->cacheKey.objects = 6;
    EXPECT_TRUE(isRegrouped(*lamp, wantedOf(sceneOfLamps(4), kRoomForTwo)));
}

TEST(IsRegrouped, NotALightThatIsGoneMovedOrByItself) {
    const std::unique_ptr<Layer> lamp = layerOf(wantedOf(sceneOfLamps(2), kRoomForTwo)[1]);
    EXPECT_FALSE(isRegrouped(*lamp, wantedOf(sceneOfLamps(1), kRoomForTwo)));
    EXPECT_FALSE(isRegrouped(*lamp, wantedOf(sceneOfLamps(2), kRoomForTwo)));
    Scene moved = sceneOfLamps(4);
    moved.lights[1].transform[3].y = 1.0f;
    EXPECT_FALSE(isRegrouped(*lamp, wantedOf(moved, kRoomForTwo)));
}

TEST(IsRegrouped, NotALightThatIsDarkInItsGroup) {
    const std::unique_ptr<Layer> lamp = layerOf(wantedOf(sceneOfLamps(2), kRoomForTwo)[1]);
    EXPECT_FALSE(isRegrouped(*lamp, wantedOf(sceneOfLamps(4), kRoomForTwo, muted({1}))));
}

TEST(IsRegrouped, AGroupWheneverItIsNotWanted) {
    const std::unique_ptr<Layer> group = layerOf(wantedOf(sceneOfLamps(4), kRoomForTwo)[1]);
    EXPECT_TRUE(isRegrouped(*group, wantedOf(sceneOfLamps(2), kRoomForTwo)));
    EXPECT_TRUE(isRegrouped(*group, {}));
}

TEST(StandIn, IsForLightsThatGoIntoAGroup) {
    EXPECT_EQ(Regrouping(sceneOfLamps(2)).planFor(sceneOfLamps(4)), "lamp 0, (rest) = lamp 1");
    EXPECT_EQ(Regrouping(sceneOfLamps(3)).planFor(sceneOfLamps(4)), "lamp 0, (rest) = lamp 1 + lamp 2");
}

TEST(StandIn, IsForLightsThatComeOutOfAGroup) {
    EXPECT_EQ(Regrouping(sceneOfLamps(4)).planFor(sceneOfLamps(2)), "lamp 0, (lamp 1) = rest");
    EXPECT_EQ(Regrouping(sceneOfLamps(4)).planFor(sceneOfLamps(3)), "lamp 0, (lamp 1), (lamp 2) = rest");
}

TEST(StandIn, IsNotForALightThatMoves) {
    Scene moved = sceneOfLamps(2);
    moved.lights[1].transform[3].y = 1.0f;
    EXPECT_EQ(Regrouping(sceneOfLamps(2)).planFor(moved), "lamp 0, lamp 1");
}

TEST(StandIn, IsNotForALightThatMovesInItsGroup) {
    Scene moved = sceneOfLamps(4);
    moved.lights[2].transform[3].y = 1.0f;
    EXPECT_EQ(Regrouping(sceneOfLamps(4)).planFor(moved), "lamp 0, rest");
    moved.lights[2].intensity = 4.0f;
    EXPECT_EQ(Regrouping(sceneOfLamps(4)).planFor(moved), "lamp 0, rest");
}

TEST(StandIn, IsNotForWhatStays) {
    EXPECT_EQ(Regrouping(sceneOfLamps(4)).planFor(sceneOfLamps(4)), "lamp 0, rest");
    EXPECT_EQ(Regrouping(sceneOfLamps(2)).planFor(sceneOfLamps(1)), "lamp 0");
    EXPECT_EQ(Regrouping(sceneOfLamps(1)).planFor(sceneOfLamps(2)), "lamp 0, lamp 1");
}

TEST(StandIn, IsNotForAGroupThatGrows) {
    EXPECT_EQ(Regrouping(sceneOfLamps(4)).planFor(sceneOfLamps(5)), "lamp 0, rest");
}

// Nobody knows of the lamp in it, which has no share in what is shown.
TEST(StandIn, IsNotForALightThatWasDarkInItsGroup) {
    EXPECT_EQ(Regrouping(sceneOfLamps(4), muted({1})).planFor(sceneOfLamps(2)), "lamp 0, lamp 1");
}

TEST(StandIn, IsNotForALightThatWasOff) {
    EXPECT_EQ(Regrouping(sceneOfLamps(2), muted({1})).planFor(sceneOfLamps(4)), "lamp 0, rest");
}

TEST(StandIn, IsNotForALightThatIsDarkInItsGroupNow) {
    EXPECT_EQ(Regrouping(sceneOfLamps(2)).planFor(sceneOfLamps(4), muted({1})), "lamp 0, rest");
}

TEST(StandIn, IsOfWhatIsShown) {
    Regrouping edit(sceneOfLamps(2));
    edit.store->layers()[1]->level = {};
    EXPECT_EQ(edit.planFor(sceneOfLamps(4)), "lamp 0, rest") << "there is nothing to be seen of it";
    Regrouping again(sceneOfLamps(2));
    again.store->layers()[1]->covered = true;
    EXPECT_EQ(again.planFor(sceneOfLamps(4)), "lamp 0, rest") << "another stand-in shows it";
}

TEST(StandIn, IsOfTheFormerLayerWhereThatIsShown) {
    Regrouping edit(sceneOfLamps(4));
    Layer& group = *edit.store->layers()[1];
    group.before = layerOf(wantedOf(sceneOfLamps(4), kRoomForTwo)[1]);
    group.level = {};
    EXPECT_EQ(edit.planFor(sceneOfLamps(2)), "lamp 0, (lamp 1) = rest");
}

TEST(StandIn, IsOfWhoShinesInTheFormerLayer) {
    Scene moved = sceneOfLamps(4);
    moved.lights[1].transform[3].y = 1.0f;
    Regrouping edit(sceneOfLamps(4));
    edit.adopt(moved); // nothing of this is seen
    EXPECT_EQ(edit.planFor(sceneOfLamps(2)), "lamp 0, (lamp 1) = rest");
}

TEST(StandIn, LeavesOutOthersThatChangeBesideIt) {
    Scene scene = sceneOfLamps(4);
    scene.lights[0].transform[3].y = 1.0f;
    EXPECT_EQ(Regrouping(sceneOfLamps(3)).planFor(scene), "lamp 0, (rest) = lamp 1 + lamp 2");
}

TEST(StandIn, LeavesAGroupThatIsThereUncovered) {
    Scene suns = sceneOfLamps(5);
    for (size_t i = 1; i < 5; ++i)
        suns.lights[i].type = LightType::Directional;
    Regrouping edit(suns);
    addPointLight(suns);
    EXPECT_EQ(edit.planFor(suns), "directional, (rest) = lamp 0");
}

TEST(StandIn, IsNotForAGroupThatComesBack) {
    Regrouping edit(sceneOfLamps(4));
    edit.bake(sceneOfLamps(3));
    EXPECT_EQ(edit.planFor(sceneOfLamps(4)), "lamp 0, rest");
}

PatchSet patchesOf(size_t count) {
    PatchSet set;
    set.scene.patches.resize(count);
    return set;
}

TEST(LayerRoom, IsForTwoBuffersOfEachLayer) {
    const PatchSet patches = patchesOf(1000); // 32,000 bytes per layer
    EXPECT_EQ(layerRoom(patches, 31'999), 0u);
    EXPECT_EQ(layerRoom(patches, 32'000), 1u);
    EXPECT_EQ(layerRoom(patches, 95'999), 2u);
}

TEST(LayerProblem, IsThereWhereNotEvenGroupsFindRoom) {
    const PatchSet patches = patchesOf(1000);
    EXPECT_NE(layerProblem(sceneOfLamps(4), patches, 95'999), "");
    EXPECT_EQ(layerProblem(sceneOfLamps(4), patches, 96'000), "");
    EXPECT_EQ(layerProblem(sceneOfLamps(2), patches, 64'000), "");
    EXPECT_NE(layerProblem(sceneOfLamps(2), patches, 63'999), "");
    EXPECT_EQ(layerProblem(sceneOfLamps(0), patches, 0), "");
}

TEST(LayerProblem, TellsWhatIsNeeded) {
    const PatchSet patches = patchesOf(size_t{1} << 20);
    EXPECT_EQ(layerProblem(sceneOfLamps(4), patches, 1 << 20),
              "layers of 4 lights take 0.1 GiB in groups, 0.0 may be taken: use a smaller lightmap, or bake "
              "without layers");
    EXPECT_EQ(layerProblem(sceneOfLamps(2), patches, 1 << 20),
              "layers of 2 lights take 0.1 GiB, 0.0 may be taken: use a smaller lightmap, or bake without "
              "layers");
}

std::string namesOf(const std::vector<WantedLayer>& wanted) {
    std::string names;
    for (const WantedLayer& layer : wanted)
        names += (names.empty() ? "" : ", ") + layer.source.name;
    return names;
}

TEST(NamedLayers, AreThoseOfTheseLightsInTheScenesOrder) {
    const Scene scene = sceneOfLamps(5);
    const std::vector<std::string> names = {"lamp 3", "lamp 1"};
    const std::vector<WantedLayer> named =
        wantedLayers(scene, {}, kRoomForAll, {.surfaces = 1, .objects = 1}, names);
    EXPECT_EQ(namesOf(named), "lamp 1, lamp 3");
    const std::vector<WantedLayer> all = wantedOf(scene, kRoomForAll);
    EXPECT_EQ(named[0].cacheKey, all[1].cacheKey);
    EXPECT_EQ(named[1].source.key, all[3].source.key);
}

TEST(NamedLayers, HaveRoomWhereThoseOfAllLightsWouldBeGrouped) {
    const Scene scene = sceneOfLamps(9);
    const std::vector<std::string> names = {"lamp 0", "lamp 7", "lamp 8"};
    EXPECT_EQ(namesOf(wantedLayers(scene, {}, kRoomForTwo, {.surfaces = 1, .objects = 1}, names)),
              "lamp 0, lamp 7, lamp 8");
    EXPECT_EQ(namesOf(wantedOf(scene, kRoomForTwo)), "lamp 0, rest");
}

TEST(NamedLayers, AreNeverGroupedButRefused) {
    const PatchSet patches = patchesOf(1000);
    const std::vector<std::string> names = {"lamp 0", "lamp 1", "lamp 2", "lamp 3"};
    EXPECT_EQ(layerProblem(sceneOfLamps(9), patches, 128'000, names), "");
    EXPECT_EQ(layerProblem(sceneOfLamps(9), patches, 127'999, names),
              "layers of 4 lights take 0.0 GiB, 0.0 may be taken: name fewer lights, or give more "
              "--layer-memory");
}

} // namespace
} // namespace relume
