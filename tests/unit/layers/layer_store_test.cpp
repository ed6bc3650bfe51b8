// What LayerStore keeps, forgets and records. No layer here has a buffer, so that there is no device.
#include "tests/unit/no_device.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

// A wanted layer of a lamp that stands at this place.
WantedLayer lampAt(float place, uint32_t lamp = 0) {
    WantedLayer wanted;
    wanted.source.key = {LightKey::Kind::Lamp, lamp, 0};
    wanted.source.weight = glm::vec3(1.0f);
    wanted.cacheKey.kind = LightKey::Kind::Lamp;
    wanted.cacheKey.light.transform[3] = glm::vec4(place, static_cast<float>(lamp), 0.0f, 1.0f);
    return wanted;
}

// A wanted group; those of its lamps that shine stand at these places.
WantedLayer groupOf(const std::vector<float>& places) {
    WantedLayer wanted;
    wanted.source.key = {LightKey::Kind::Group, 0, 0};
    wanted.cacheKey.kind = LightKey::Kind::Group;
    wanted.members.resize(3);
    for (const float place : places) {
        wanted.cacheKey.members.push_back(lampAt(place).cacheKey);
        wanted.cacheKey.weights.emplace_back(1.0f);
    }
    wanted.source.weight = glm::vec3(places.empty() ? 0.0f : 1.0f);
    return wanted;
}

using Inherit = std::function<void(const Layer&, Layer&)>;

void replaceBy(
    StoreWithoutDevice& store, const std::vector<WantedLayer>& wanted,
    const Inherit& inherit = [](const Layer&, Layer&) {}) {
    store->replace(wanted, store->take(wanted), std::vector<bool>(wanted.size(), false), inherit);
}

Layer& layerIn(const StoreWithoutDevice& store, size_t index = 0) {
    return *store->layers()[index];
}

void bakeTo(Layer& layer, LayerLevel level, std::vector<uint32_t> steps) {
    layer.level = level;
    layer.directSamplePasses = steps.back();
    layer.directSteps = std::move(steps);
}

// Bakes the lamp at each of these places in turn, with one level each.
void visit(StoreWithoutDevice& store, std::initializer_list<float> places) {
    for (const float place : places) {
        replaceBy(store, {lampAt(place)});
        Layer& layer = layerIn(store);
        bakeTo(layer, {2, 2}, {2});
        if (layer.before) store->archive(std::move(layer.before));
    }
}

TEST(LayerStore, KeepsLayersInTheOrderInWhichTheyAreWanted) {
    StoreWithoutDevice store(9);
    replaceBy(store, {lampAt(1, 0), lampAt(2, 1)});
    const Layer* first = &layerIn(store, 0);
    replaceBy(store, {lampAt(2, 1), lampAt(3, 2), lampAt(1, 0)});
    ASSERT_EQ(store->layers().size(), 3u);
    EXPECT_EQ(&layerIn(store, 2), first);
    EXPECT_EQ(layerIn(store, 1).source.key.index, 2u);
}

TEST(LayerStore, TakesWhatIsThereAndNothingElse) {
    StoreWithoutDevice store(9);
    replaceBy(store, {lampAt(1, 0), lampAt(2, 1)});
    const Layer* second = &layerIn(store, 1);
    const auto taken = store->take({lampAt(7, 0), lampAt(2, 1)});
    EXPECT_EQ(taken[0], nullptr);
    EXPECT_EQ(taken[1].get(), second);
    EXPECT_EQ(store->layers().size(), 1u) << "what was taken is no longer there";
}

TEST(LayerStore, KnowsItsOwn) {
    StoreWithoutDevice store(9);
    replaceBy(store, {lampAt(1)});
    const Layer other;
    EXPECT_TRUE(store->holds(&layerIn(store)));
    EXPECT_FALSE(store->holds(&other));
    EXPECT_FALSE(store->holds(nullptr));
}

TEST(LayerStore, WeightsAreThoseOfTheNewestEdit) {
    StoreWithoutDevice store(9);
    replaceBy(store, {lampAt(1)});
    WantedLayer dimmed = lampAt(1);
    dimmed.source.weight = glm::vec3(0.5f);
    dimmed.source.name = "other";
    replaceBy(store, {dimmed});
    EXPECT_EQ(layerIn(store).source.weight, glm::vec3(0.5f));
    EXPECT_EQ(layerIn(store).source.name, "other");
}

TEST(LayerStore, WhatMovedShowsTheFormerLayer) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    const Layer* former = &layerIn(store);
    replaceBy(store, {lampAt(2)});
    EXPECT_NE(&layerIn(store), former);
    EXPECT_FALSE(layerIn(store).has());
    EXPECT_EQ(layerIn(store).shown(), former);
}

TEST(LayerStore, WhatMovesOnShowsTheLastThatWasSeen) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    const Layer* seen = &layerIn(store);
    replaceBy(store, {lampAt(2)});
    replaceBy(store, {lampAt(3)});
    EXPECT_EQ(layerIn(store).shown(), seen);
    EXPECT_EQ(layerIn(store).before.get(), seen) << "places between are not kept";
}

TEST(LayerStore, ANewLightShowsNothing) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    replaceBy(store, {lampAt(1), lampAt(2, 1)});
    EXPECT_EQ(layerIn(store, 1).shown(), nullptr);
}

TEST(LayerStore, AnEditThatIsTakenBackBeforeItIsSeenCostsNothing) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    const Layer* former = &layerIn(store);
    replaceBy(store, {lampAt(2)});
    replaceBy(store, {lampAt(1)});
    EXPECT_EQ(&layerIn(store), former);
    EXPECT_EQ(layerIn(store).level, (LayerLevel{2, 2}));
}

TEST(LayerStore, AnUndoFindsTheFormerLayer) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    const Layer* former = &layerIn(store);
    visit(store, {2, 3, 4});
    replaceBy(store, {lampAt(1)});
    EXPECT_EQ(&layerIn(store), former);
    EXPECT_FALSE(layerIn(store).redo);
}

TEST(LayerStore, ALightThatIsDeletedIsKeptForAnUndo) {
    StoreWithoutDevice store(9);
    replaceBy(store, {lampAt(1, 0), lampAt(2, 1)});
    for (const size_t i : {0, 1})
        bakeTo(layerIn(store, i), {2, 2}, {2});
    const Layer* deleted = &layerIn(store, 1);
    replaceBy(store, {lampAt(1, 0)});
    replaceBy(store, {lampAt(1, 0), lampAt(2, 1)});
    EXPECT_EQ(&layerIn(store, 1), deleted);
}

TEST(LayerStore, ADeletedLightsFormerLayerIsKeptWhereNothingElseIsSeen) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    const Layer* seen = &layerIn(store);
    replaceBy(store, {lampAt(2)});
    replaceBy(store, {});
    replaceBy(store, {lampAt(1)});
    EXPECT_EQ(&layerIn(store), seen);
}

TEST(LayerStore, WhatShowsNothingIsNotKept) {
    StoreWithoutDevice store(9);
    replaceBy(store, {lampAt(1)});
    layerIn(store).directSamplePasses = 2;
    replaceBy(store, {});
    replaceBy(store, {lampAt(1)});
    EXPECT_EQ(layerIn(store).directSamplePasses, 0u);
    EXPECT_FALSE(layerIn(store).redo) << "it had no level to come back to";
}

// With room for four there are one that is shown, two former ones and a spare one.
TEST(LayerStore, BeyondTheMemoryTheOldestIsForgotten) {
    for (const float place : {1.0f, 2.0f, 3.0f}) {
        StoreWithoutDevice store(4);
        visit(store, {1, 2, 3, 4});
        replaceBy(store, {lampAt(place)});
        EXPECT_EQ(layerIn(store).has(), place > 1.0f) << place;
    }
}

// Where the device has room for one alone, the host holds as many former ones as are shown, and no more.
TEST(LayerStore, BeyondTheDeviceFewerFormerOnesAreKept) {
    for (const float place : {1.0f, 2.0f}) {
        StoreWithoutDevice store(9, 1);
        visit(store, {1, 2, 3});
        replaceBy(store, {lampAt(place)});
        EXPECT_EQ(layerIn(store).has(), place > 1.0f) << place;
    }
}

TEST(LayerStore, OfWhatIsForgottenLevelAndStepsAreKnown) {
    StoreWithoutDevice store(3);
    replaceBy(store, {lampAt(1)});
    bakeTo(layerIn(store), {16, 8}, {2, 16});
    visit(store, {2, 3, 4});
    replaceBy(store, {lampAt(1)});
    EXPECT_FALSE(layerIn(store).has());
    EXPECT_EQ(layerIn(store).redo, (LayerLevel{16, 8}));
    EXPECT_EQ(layerIn(store).redoSteps, (std::vector<uint32_t>{2, 16}));
}

TEST(LayerStore, StepsThatAreOfNoLevelYetAreNotKnown) {
    StoreWithoutDevice store(3);
    replaceBy(store, {lampAt(1)});
    bakeTo(layerIn(store), {4, 8}, {2, 4, 16});
    visit(store, {2, 3, 4});
    replaceBy(store, {lampAt(1)});
    EXPECT_EQ(layerIn(store).redoSteps, (std::vector<uint32_t>{2, 4}));
}

TEST(LayerStore, ARecordIsOfTheLastTimeThatALayerWasThere) {
    StoreWithoutDevice store(3);
    visit(store, {1, 2, 3, 4});
    replaceBy(store, {lampAt(1)});
    layerIn(store).redo.reset();
    bakeTo(layerIn(store), {32, 16}, {2, 8, 32});
    visit(store, {2, 3, 4});
    replaceBy(store, {lampAt(1)});
    EXPECT_EQ(layerIn(store).redo, (LayerLevel{32, 16}));
    EXPECT_EQ(layerIn(store).redoSteps, (std::vector<uint32_t>{2, 8, 32}));
}

TEST(LayerStore, WhatIsOnItsWayBackKeepsItsRecord) {
    StoreWithoutDevice store(3);
    replaceBy(store, {lampAt(1)});
    bakeTo(layerIn(store), {16, 8}, {2, 16});
    visit(store, {2, 3, 4});
    replaceBy(store, {lampAt(1)});
    bakeTo(layerIn(store), {2, 2}, {2}); // its redo is still to come
    visit(store, {2, 3, 4});
    replaceBy(store, {lampAt(1)});
    EXPECT_EQ(layerIn(store).redo, (LayerLevel{16, 8}));
}

TEST(LayerStore, ALayerInheritsFromTheFormerOneOfItsLight) {
    StoreWithoutDevice store(9);
    replaceBy(store, {lampAt(1, 0), lampAt(2, 1)});
    std::vector<std::pair<float, float>> heard;
    replaceBy(store, {lampAt(1, 0), lampAt(5, 1), lampAt(6, 2)}, [&](const Layer& from, Layer& to) {
        heard.emplace_back(from.cacheKey.light.transform[3].x, to.cacheKey.light.transform[3].x);
        to.directSamplePasses = 3;
    });
    EXPECT_EQ(heard, (std::vector<std::pair<float, float>>{{2.0f, 5.0f}}));
    EXPECT_EQ(layerIn(store, 1).directSamplePasses, 3u);
}

TEST(LayerStore, DirectLightThatWasInheritedInOtherStepsIsNotTaken) {
    const auto inheritedAs = [](const std::vector<uint32_t>& steps) {
        StoreWithoutDevice store(3);
        replaceBy(store, {lampAt(1)});
        bakeTo(layerIn(store), {16, 8}, {2, 16});
        visit(store, {2, 3, 4});
        replaceBy(store, {lampAt(1)}, [&](const Layer&, Layer& to) {
            to.directSteps = steps;
            to.directSamplePasses = steps.back();
            to.dirty = {Layer::kDirty};
            to.begun = true;
            to.penumbra = {1};
        });
        const Layer& layer = layerIn(store);
        EXPECT_EQ(layer.dirty.empty(), layer.directSamplePasses == 0);
        EXPECT_EQ(layer.begun, layer.directSamplePasses > 0);
        EXPECT_EQ(layer.penumbra.empty(), layer.directSamplePasses == 0);
        EXPECT_EQ(layer.redo, (LayerLevel{16, 8}));
        return layer.directSteps;
    };
    EXPECT_EQ(inheritedAs({2, 16}), (std::vector<uint32_t>{2, 16}));
    EXPECT_EQ(inheritedAs({2}), (std::vector<uint32_t>{2})) << "the rest is made in the steps it had";
    EXPECT_EQ(inheritedAs({4, 16}), (std::vector<uint32_t>{}));
    EXPECT_EQ(inheritedAs({2, 16, 32}), (std::vector<uint32_t>{}));
}

TEST(LayerStore, AGroupOfWhichNothingShinesStaysAsItIs) {
    StoreWithoutDevice store(9);
    replaceBy(store, {groupOf({1, 2, 3})});
    bakeTo(layerIn(store), {2, 2}, {2});
    const Layer* group = &layerIn(store);
    replaceBy(store, {groupOf({})});
    EXPECT_EQ(&layerIn(store), group);
    EXPECT_FALSE(layerIn(store).shines());
    EXPECT_EQ(layerIn(store).cacheKey.members.size(), 3u) << "it may shine again as it did";
    replaceBy(store, {groupOf({1, 2, 3})});
    EXPECT_EQ(&layerIn(store), group);
    EXPECT_TRUE(layerIn(store).shines());
}

TEST(LayerStore, AGroupThatShinesOtherwiseIsANewLayer) {
    StoreWithoutDevice store(9);
    replaceBy(store, {groupOf({1, 2, 3})});
    bakeTo(layerIn(store), {2, 2}, {2});
    const Layer* group = &layerIn(store);
    replaceBy(store, {groupOf({1, 2})});
    EXPECT_FALSE(layerIn(store).has());
    EXPECT_EQ(layerIn(store).shown(), group);
}

TEST(LayerStore, WhatStandsInForALayerStandsInForTheNextOfItsLight) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    layerIn(store).covered = true;
    replaceBy(store, {lampAt(2)});
    EXPECT_TRUE(layerIn(store).covered);
    EXPECT_FALSE(layerIn(store).before->covered);
}

TEST(LayerStore, WhatIsCoveredIsToldOfNewAndOfKeptLayers) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    const std::vector<WantedLayer> wanted = {lampAt(1), lampAt(2, 1), lampAt(3, 2)};
    store->replace(wanted, store->take(wanted), {true, true, false}, [](const Layer&, Layer&) {});
    EXPECT_TRUE(layerIn(store, 0).covered);
    EXPECT_TRUE(layerIn(store, 1).covered);
    EXPECT_FALSE(layerIn(store, 2).covered);
}

TEST(LayerStore, WhatComesBackIsNotCovered) {
    StoreWithoutDevice store(9);
    visit(store, {1});
    layerIn(store).covered = true;
    replaceBy(store, {});
    replaceBy(store, {lampAt(1)});
    EXPECT_TRUE(layerIn(store).has());
    EXPECT_FALSE(layerIn(store).covered);
}

} // namespace
} // namespace relume
