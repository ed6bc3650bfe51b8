// What edits do to the order, as LayerSchedule decides on it: when they are taken, what is made of objects
// that move, and when the sum of all lights is shown.
#include "tests/unit/layer_facts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

constexpr ScheduleRules kDirectAlone{.passes = 1, .live = true, .together = true};

bool takes(const ScheduleRules& rules, const LayerSchedule::Layers& layers, const ScheduleState& state) {
    return LayerSchedule(rules).takesEdits(layers, state);
}

bool rests(const ScheduleRules& rules, const LayerSchedule::Layers& layers, const ScheduleState& state) {
    return LayerSchedule(rules).atRest(layers, state);
}

bool wantsSum(const LayerSchedule::Layers& layers, bool shown = false,
              const ScheduleRules& rules = viewerRules()) {
    return LayerSchedule(rules).wantsSum(layers, shown);
}

bool canSum(const LayerSchedule::Layers& layers, bool shown = false,
            const ScheduleRules& rules = viewerRules()) {
    return LayerSchedule(rules).canSum(layers, shown);
}

bool isWhole(const LayerSchedule::Layers& layers, const ScheduleState& state = Now()) {
    return LayerSchedule(viewerRules()).isWhole(layers, state);
}

// Tells which layer is to be repaired; -1 for none.
int dirtyOf(const LayerSchedule::Layers& layers, const ScheduleRules& rules = viewerRules()) {
    const std::optional<size_t> dirty = LayerSchedule(rules).dirtyLayer(layers);
    return dirty ? static_cast<int>(*dirty) : -1;
}

uint32_t sumSamplePassesOf(const LayerSchedule::Layers& layers, uint32_t links = 16) {
    return LayerSchedule({.linksOfSamplePass = links, .live = true}).sumSamplePasses(layers);
}

struct Moment {
    const char* name;
    ScheduleState state;
    bool takesEdits;
};

const Moment kMoments[] = {
    {"NothingIsUnderWay", Now(), true},
    {"AFirstLevelIsUnderWay", Now().makingFirstLevel(), false},
    {"ALaterLevelIsUnderWay", Now().makingLaterLevel(), true},
    {"TheSumIsDue", Now().sumDue(), false},
    {"TheSumIsDueBesideALaterLevel", Now().sumDue().makingLaterLevel(), false},
    {"TheSumIsUnderWay", Now().makingSum(), false},
    {"TheSumIsShown", Now().sumShown(), true},
    {"TheSumIsShownBesideAFirstLevel", Now().sumShown().makingFirstLevel(), true},
    {"TheSumIsShownBesideALaterLevel", Now().sumShown().makingLaterLevel(), true},
    {"TheSumIsMadeAgain", Now().sumShown().makingSum(), false},
    {"TheSumIsDueAgain", Now().sumShown().sumDue(), false},
    {"LinksFollowObjects", Now().relinking(2), true},
    {"LinksFollowObjectsBesideAFirstLevel", Now().relinking(2).makingFirstLevel(), false},
    {"ColoursAreNotSeenYet", Now().notSeen(), true},
};

class EditComes : public testing::TestWithParam<Moment> {};

TEST_P(EditComes, WhileTwoLayersHaveDirectLight) {
    for (const ScheduleRules& rules : {viewerRules(), offlineRules()})
        EXPECT_EQ(takes(rules, layersOf(lit(2), lit(2)), GetParam().state), GetParam().takesEdits);
}

TEST_P(EditComes, WhileTwoLayersHaveALevel) {
    EXPECT_EQ(takes(viewerRules(), layersOf(at(2, 2), at(8, 8).converged()), GetParam().state),
              GetParam().takesEdits);
}

TEST_P(EditComes, WhileColoursMayChangeToo) {
    const LayerSchedule::Layers layers = layersOf(lit(2), lit(2));
    EXPECT_EQ(rests(offlineRules(), layers, GetParam().state), GetParam().takesEdits);
    EXPECT_EQ(rests(viewerRules(), layers, GetParam().state),
              GetParam().takesEdits && !GetParam().state.unseen);
}

INSTANTIATE_TEST_SUITE_P(Moments, EditComes, testing::ValuesIn(kMoments), CaseName());

TEST(EditWaits, ForTheDirectLightOfWhatIsNewAmongAllLights) {
    EXPECT_FALSE(takes(viewerRules(), layersOf(lit(2), fresh()), Now().sumShown()));
    EXPECT_TRUE(takes(viewerRules(), layersOf(lit(2), lit(1)), Now().sumShown()));
    EXPECT_TRUE(takes(viewerRules(), layersOf(lit(2), fresh().switchedOff()), Now().sumShown()));
}

TEST(EditWaits, ForDirectLightThatTheFirstSumNeeds) {
    EXPECT_FALSE(takes(viewerRules(), layersOf(lit(2), fresh()), Now().notSeen()));
    EXPECT_FALSE(takes(viewerRules(), layersOf(lit(2), fresh()), Now().notSeen().makingLaterLevel()));
    EXPECT_TRUE(takes(viewerRules(), layersOf(lit(2), fresh()), Now()));
}

TEST(EditWaits, NotForDirectLightWhereNoSumIsWanted) {
    EXPECT_TRUE(takes(viewerRules(), layersOf(at(2, 2), fresh()), Now().notSeen()));
    EXPECT_TRUE(takes(offlineRules(), layersOf(fresh(), fresh()), Now().notSeen()));
    EXPECT_TRUE(takes(kDirectAlone, layersOf(fresh(), fresh()), Now().notSeen()));
}

TEST(EditWaits, NotForARepair) {
    EXPECT_TRUE(takes(viewerRules(), layersOf(lit(2), lit(2).outdated()), Now().sumShown()));
    EXPECT_TRUE(takes(viewerRules(), layersOf(lit(2), lit(2).begun()), Now().notSeen()));
}

TEST(NewLight, GetsDirectLightWhileTheSumIsShown) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), fresh()), Now().sumShown()), "direct light of 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2), at(2, 2), fresh()), Now().sumShown()),
              "direct light of 2 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), fresh()), Now()), "layer 0 to 2+2");
}

TEST(NewLight, GetsDirectLightBeforeTheFirstSum) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), fresh()), Now().notSeen()), "direct light of 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2), fresh()), Now().notSeen()), "layer 1 to 2+2");
}

TEST(NewLight, OfSeveralTheFirstInOrder) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().switchedOff(), fresh(), fresh()), Now().sumShown()),
              "direct light of 1 to 2+2");
}

TEST(NewLight, OfADarkLevelTheSunAndTheSkyFirst) {
    constexpr auto kBulb = LightType::Point, kSun = LightType::Directional;
    EXPECT_EQ(
        stepOf(viewerRules(), layersOf(fresh().lamp(kBulb), fresh().lamp(kSun), fresh()), Now().notSeen()),
        "direct light of 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh().lamp(kBulb), lit(2), fresh()), Now().notSeen()),
              "direct light of 2 to 2+2");
    EXPECT_EQ(
        stepOf(viewerRules(), layersOf(fresh().lamp(kBulb), fresh().lamp(kBulb), lit(2)), Now().notSeen()),
        "direct light of 0 to 2+2");
}

TEST(FirstSum, IsOfDaylightAlone) {
    constexpr auto kBulb = LightType::Point, kSun = LightType::Directional;
    const LayerSchedule schedule(viewerRules());
    EXPECT_TRUE(schedule.canSum(layersOf(fresh().lamp(kBulb), lit(2).lamp(kSun), lit(2)), false));
    EXPECT_FALSE(schedule.canSum(layersOf(fresh().lamp(kBulb), lit(2).lamp(kSun), lit(2)), true))
        << "the second one is of all lights";
    EXPECT_FALSE(schedule.canSum(layersOf(fresh().lamp(kBulb), lit(2).lamp(kSun), fresh()), false))
        << "the sky lacks";
    EXPECT_FALSE(schedule.canSum(layersOf(fresh().lamp(kBulb), lit(2).lamp(kBulb)), false)) << "no daylight";
    EXPECT_FALSE(schedule.canSum(
        layersOf(fresh().lamp(kBulb), fresh().lamp(kBulb), lit(2).lamp(kSun), at(2, 2)), false))
        << "one layer is shown already";
    EXPECT_TRUE(schedule.canSum(layersOf(lit(2).lamp(kBulb), lit(2).lamp(kSun)), true));
}

TEST(NewLight, ThatIsOffGetsNone) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), lit(2), fresh().switchedOff()), Now().sumShown()),
              "layer 0 to 2+2");
    EXPECT_EQ(
        stepOf(viewerRules(), layersOf(lit(2), lit(2), fresh().group().switchedOff()), Now().sumShown()),
        "layer 0 to 2+2");
}

TEST(NewLight, AGroupThatShinesGetsItsOwn) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), fresh().group()), Now().sumShown()),
              "direct light of 1 to 2+2");
}

TEST(NewLight, WaitsForLinksOfTheSum) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), fresh()), Now().sumShown().relinking(3)), "relink");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), fresh()), Now().sumShown().relinking(4)),
              "direct light of 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), fresh()), Now().notSeen().relinking(4)),
              "direct light of 1 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(2), fresh()), Now().notSeen().relinking(4)), "relink");
}

TEST(ObjectMoves, WhatIsOfFormerPlacesIsRepairedFirst) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh(), lit(2).outdated())), "layer 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh(), lit(2).beside())), "layer 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(fresh(), lit(2).begun())), "layer 1 to 2+2");
}

TEST(ObjectMoves, TheFirstStepOfEachComesBeforeTheOthers) {
    EXPECT_EQ(dirtyOf(layersOf(lit(2), lit(2).begun(), lit(2).outdated(), lit(2).outdated())), 2);
    EXPECT_EQ(dirtyOf(layersOf(lit(2).begun(), lit(2), lit(2).beside())), 2);
    EXPECT_EQ(dirtyOf(layersOf(lit(2), lit(2).begun(), lit(2).begun())), 1);
    EXPECT_EQ(dirtyOf(layersOf(lit(2), fresh())), -1);
}

TEST(ObjectMoves, WhatIsOffIsNotRepaired) {
    EXPECT_EQ(dirtyOf(layersOf(lit(2).outdated().switchedOff(), lit(2).begun())), 1);
    EXPECT_EQ(dirtyOf(layersOf(lit(2).outdated().switchedOff(), lit(2).begun().switchedOff())), -1);
}

TEST(ObjectMoves, OfflineThereIsNoHasteToRepair) {
    EXPECT_EQ(dirtyOf(layersOf(lit(2).outdated()), offlineRules()), -1);
    EXPECT_EQ(stepOf(offlineRules(), layersOf(fresh(), lit(2).outdated())), "layer 0 to 2+2");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(at(2, 2), lit(2).outdated())), "layer 1 to 2+2");
}

TEST(ObjectMoves, AFirstStepComesBeforeTheDirectLightOfANewLight) {
    const auto layers = [](auto&& moved) { return layersOf(fresh(), moved, lit(2)); };
    EXPECT_EQ(stepOf(viewerRules(), layers(lit(2).outdated()), Now().notSeen()), "layer 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layers(lit(2).beside()), Now().sumShown()), "layer 1 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layers(lit(2).begun()), Now().notSeen()), "direct light of 0 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layers(lit(2).begun()), Now().sumShown()), "direct light of 0 to 2+2");
}

TEST(ObjectMoves, TheRestComesBeforeAnyLayerGoesOn) {
    EXPECT_EQ(
        stepOf(viewerRules(), layersOf(lit(2), lit(16).redo({16, 8}, {2, 16}).begun()), Now().sumShown()),
        "layer 1 to 16+8");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(at(2, 2).off(0.9), lit(2).begun())), "layer 1 to 2+2");
}

TEST(ObjectMoves, ARepairIsNeverForOthersToComeAlong) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(8).redo({8, 8}).outdated(), lit(2).redo({8, 8}))),
              "layer 0 to 8+8");
}

TEST(ObjectMoves, LinksBeyondTheSumsWaitForTheRepair) {
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2).outdated(), lit(2)), Now().relinking(3)), "relink");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2).outdated(), lit(2)), Now().relinking(4)),
              "layer 0 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2).begun(), lit(2)), Now().relinking(4)), "layer 0 to 2+2");
    EXPECT_EQ(stepOf(viewerRules(), layersOf(lit(2), lit(2)), Now().relinking(4)), "relink");
    EXPECT_EQ(stepOf(offlineRules(), layersOf(lit(2).outdated(), lit(2)), Now().relinking(4)), "relink");
}

TEST(ObjectMoves, AtRestOnlyWhereTheLastPlaceWasSeen) {
    const auto layers = [] { return layersOf(lit(2), lit(2)); };
    EXPECT_FALSE(rests(viewerRules(), layers(), Now().notSeen()));
    EXPECT_FALSE(rests(viewerRules(), layers(), Now().notSeen().sumShown()));
    EXPECT_TRUE(rests(viewerRules(), layers(), Now().sumShown().makingFirstLevel()));
    EXPECT_TRUE(rests(offlineRules(), layers(), Now().notSeen()));
}

TEST(SumIsWanted, WhereSeveralLayersShowNothing) {
    EXPECT_TRUE(wantsSum(layersOf(lit(2), lit(2))));
    EXPECT_TRUE(wantsSum(layersOf(at(2, 2), fresh(), lit(2))));
    EXPECT_FALSE(wantsSum(layersOf(at(2, 2), at(2, 2))));
    EXPECT_FALSE(wantsSum({}));
}

TEST(SumIsWanted, NotForOneThatIsSeenAsSoonItself) {
    EXPECT_FALSE(wantsSum(layersOf(at(2, 2), lit(2))));
    EXPECT_FALSE(wantsSum(layersOf(lit(2))));
}

TEST(SumIsWanted, UntilTheLastOneIsThere) {
    EXPECT_TRUE(wantsSum(layersOf(at(2, 2), lit(2)), true));
    EXPECT_FALSE(wantsSum(layersOf(at(2, 2), at(2, 2)), true));
}

TEST(SumIsWanted, ForOneThatTakesMoreLinksThanIt) {
    EXPECT_TRUE(wantsSum(layersOf(at(2, 2), lit(8).redo({8, 5}))));
    EXPECT_FALSE(wantsSum(layersOf(at(2, 2), lit(8).redo({8, 4}))));
    EXPECT_FALSE(wantsSum(layersOf(at(2, 2), at(2, 2).redo({8, 5}))));
}

TEST(SumIsWanted, WhatIsOffDoesNotCount) {
    EXPECT_FALSE(wantsSum(layersOf(lit(2), lit(2).switchedOff())));
    EXPECT_FALSE(wantsSum(layersOf(lit(2).switchedOff(), lit(2).switchedOff()), true));
    EXPECT_FALSE(wantsSum(layersOf(at(2, 2), lit(8).redo({8, 5}).switchedOff())));
}

TEST(SumIsWanted, OnlyByAViewer) {
    EXPECT_FALSE(wantsSum(layersOf(lit(2), lit(2)), false, offlineRules()));
    EXPECT_FALSE(wantsSum(layersOf(lit(2), lit(2)), true, offlineRules()));
}

TEST(SumIsWanted, OnlyWhereLightBounces) {
    EXPECT_FALSE(wantsSum(layersOf(lit(2), lit(2)), true, kDirectAlone));
    EXPECT_TRUE(wantsSum(layersOf(lit(2), lit(2)), false, {.passes = 2, .live = true}));
}

TEST(SumCanBeMade, OfDirectLightOfAllThatShine) {
    EXPECT_TRUE(canSum(layersOf(lit(2), lit(1))));
    EXPECT_FALSE(canSum(layersOf(lit(2), lit(2), fresh())));
    EXPECT_TRUE(canSum(layersOf(lit(2), lit(2), fresh().switchedOff())));
    EXPECT_TRUE(canSum(layersOf(lit(2), lit(2), fresh().group().switchedOff())));
}

TEST(SumCanBeMade, OnceTheFirstStepHasFollowedObjects) {
    EXPECT_FALSE(canSum(layersOf(lit(2), lit(2).outdated())));
    EXPECT_FALSE(canSum(layersOf(lit(2), lit(2).beside())));
    EXPECT_TRUE(canSum(layersOf(lit(2), lit(2).begun())));
    EXPECT_TRUE(canSum(layersOf(lit(2), lit(2), lit(2).outdated().switchedOff())));
}

TEST(SumCanBeMade, OnlyWhereItIsWanted) {
    EXPECT_FALSE(canSum(layersOf(at(2, 2), at(2, 2))));
    EXPECT_FALSE(canSum(layersOf(at(2, 2), lit(2))));
    EXPECT_TRUE(canSum(layersOf(at(2, 2), lit(2)), true));
    EXPECT_FALSE(canSum(layersOf(lit(2), lit(2)), true, offlineRules()));
}

TEST(SumTakes, SixtyFourLinks) {
    for (const auto& [links, samplePasses] : {std::pair(1u, 64u), {4u, 16u}, {16u, 4u}, {32u, 2u}, {64u, 1u}})
        EXPECT_EQ(LayerSchedule({.linksOfSamplePass = links}).sumSamplePasses(), samplePasses) << links;
}

TEST(SumTakes, OneSamplePassAtLeast) {
    EXPECT_EQ(LayerSchedule({.linksOfSamplePass = 128}).sumSamplePasses(), 1u);
    EXPECT_EQ(sumSamplePassesOf(layersOf(fresh(), fresh())), 1u);
    EXPECT_EQ(sumSamplePassesOf({}), 1u);
}

TEST(SumTakes, NoMoreThanTheDeepestLayer) {
    EXPECT_EQ(sumSamplePassesOf(layersOf(at(2, 2), at(8, 3))), 3u);
    EXPECT_EQ(sumSamplePassesOf(layersOf(at(8, 3), at(2, 2))), 3u);
    EXPECT_EQ(sumSamplePassesOf(layersOf(at(2, 2), at(8, 8))), 4u);
    EXPECT_EQ(sumSamplePassesOf(layersOf(at(2, 2), at(8, 8)), 128), 1u);
}

TEST(SumTakes, WhatALayerHadWhereItHasNothingYet) {
    EXPECT_EQ(sumSamplePassesOf(layersOf(lit(8).redo({8, 3}), fresh())), 3u);
    EXPECT_EQ(sumSamplePassesOf(layersOf(at(2, 2).redo({8, 3}))), 2u);
}

TEST(SumTakes, NothingFromWhatIsOff) {
    EXPECT_EQ(sumSamplePassesOf(layersOf(at(2, 2), at(8, 3).switchedOff())), 2u);
}

TEST(IsWhole, WhereEachThatShinesHasALevel) {
    EXPECT_TRUE(isWhole(layersOf(at(2, 2), at(2, 2))));
    EXPECT_TRUE(isWhole({}));
    EXPECT_FALSE(isWhole(layersOf(at(2, 2), lit(2))));
    EXPECT_TRUE(isWhole(layersOf(at(2, 2), lit(2).switchedOff())));
    EXPECT_TRUE(isWhole(layersOf(at(2, 2), fresh()), Now().sumShown()) ==
                isWhole(layersOf(fresh()), Now().sumShown()));
}

TEST(IsWhole, WhereTheSumHasEachThatShines) {
    EXPECT_TRUE(isWhole(layersOf(lit(2), lit(2)), Now().sumShown()));
    EXPECT_FALSE(isWhole(layersOf(lit(2), fresh()), Now().sumShown()));
    EXPECT_FALSE(isWhole(layersOf(lit(2), lit(2).outdated()), Now().sumShown()));
    EXPECT_TRUE(isWhole(layersOf(lit(2), lit(2).begun()), Now().sumShown()));
    EXPECT_TRUE(isWhole(layersOf(lit(2), fresh().switchedOff()), Now().sumShown()));
}

TEST(IsWhole, NotBeforeTheSumIsThere) {
    EXPECT_FALSE(isWhole(layersOf(at(2, 2)), Now().sumDue()));
    EXPECT_FALSE(isWhole(layersOf(at(2, 2)), Now().makingSum()));
    EXPECT_FALSE(isWhole(layersOf(lit(2), lit(2)), Now().sumShown().sumDue()));
    EXPECT_FALSE(isWhole(layersOf(lit(2), lit(2)), Now().sumShown().makingSum()));
}

TEST(IsWhole, WhileLayersGoOn) {
    EXPECT_TRUE(isWhole(layersOf(at(2, 2)), Now().makingLaterLevel()));
    EXPECT_TRUE(isWhole(layersOf(lit(2), lit(2)), Now().sumShown().makingFirstLevel()));
}

LayerSchedule::Told errorOf(const LayerSchedule::Layers& layers,
                            const ScheduleRules& rules = offlineRules()) {
    return LayerSchedule(rules).told(layers);
}

// Independent errors of .2 and .4 of as much light are off by half the root of .2^2 + .4^2.
TEST(ToldError, OfDirectLightIsTheRootOfSquares) {
    const auto direct = [](double error) { return std::move(at(2, 2).noise(1, 0).off(error)); };
    EXPECT_NEAR(errorOf(layersOf(direct(0.2), direct(0.4))).error, 0.5 * std::hypot(0.2, 0.4), 1e-12);
    EXPECT_NEAR(errorOf(layersOf(direct(0.2).weighing(3), direct(0.4))).error, 0.25 * std::hypot(0.6, 0.4),
                1e-12);
    EXPECT_NEAR(errorOf(layersOf(direct(0.2).shedding(3), direct(0.4))).error, 0.25 * std::hypot(0.6, 0.4),
                1e-12);
    // A third of all channels' light, but their squares count.
    EXPECT_NEAR(errorOf(layersOf(direct(0.2).weighing({0, 0, 3}), direct(0.4))).error,
                0.5 * std::hypot(0.2 * std::sqrt(3.0), 0.4), 1e-6);
}

TEST(ToldError, OfLinksAddsUpWhereNothingIsKnown) {
    const auto indirect = [](double error) { return std::move(at(2, 2).noise(0, 1).off(error)); };
    EXPECT_NEAR(errorOf(layersOf(indirect(0.2), indirect(0.4))).error, 0.3, 1e-12);
    EXPECT_NEAR(errorOf(layersOf(indirect(0.2).weighing(3), indirect(0.4))).error, 0.25, 1e-12);
}

TEST(ToldError, OfLinksIsWhatSketchesHaveInCommon) {
    const auto sketched = [](double error, const glm::vec3& a, const glm::vec3& b) {
        return std::move(at(2, 2).noise(0, 1).off(error).sketch({a, b}));
    };
    const glm::vec3 some(5.0f), none(0.0f);
    const auto both = [&](const glm::vec3& a, const glm::vec3& b) {
        return errorOf(layersOf(sketched(0.2, some, none), sketched(0.4, a, b))).error;
    };
    EXPECT_NEAR(both(some, none), 0.3, 1e-6);                        // the same sign everywhere
    EXPECT_NEAR(both(none, some), 0.5 * std::hypot(0.2, 0.4), 1e-6); // nothing in common
    EXPECT_NEAR(both(-some, none), 0.1, 1e-6);                       // the other sign everywhere
    const LayerSchedule::Layers beside =
        layersOf(sketched(0.2, some, none), sketched(0.4, none, some), at(2, 2).noise(0, 1).off(0.3));
    EXPECT_NEAR(errorOf(beside).error, (std::hypot(0.2, 0.4) + 0.3) / 3.0, 1e-6);
}

// Products of sketches are kept from one mixture to the next, and made anew for another sketch.
TEST(ToldError, IsTheSameByProductsThatAreKept) {
    const auto sketched = [](double error, const glm::vec3& a, const glm::vec3& b) {
        LayerFacts facts = std::move(at(2, 2).noise(0, 1).off(error).sketch({a, b}));
        return facts;
    };
    LayerSchedule::Layers layers =
        layersOf(sketched(0.2, {1, 2, 3}, {-1, 0, 2}), sketched(0.4, {0, 1, -2}, {3, 1, 0}),
                 sketched(0.3, {2, -2, 1}, {1, 1, 1}));
    for (const std::unique_ptr<Layer>& layer : layers)
        layer->sketch.number = newSketchNumber();
    const LayerSchedule schedule(offlineRules());
    SketchProducts kept;
    const auto expectSame = [&] {
        EXPECT_NEAR(schedule.told(layers, {}, &kept).error, schedule.told(layers).error, 1e-12);
    };
    expectSame();
    layers[1]->source.weight = {0.5f, 3.0f, 0.25f};
    expectSame();
    const double before = schedule.told(layers).error;
    layers[2]->sketch.entries[0] = {-4, 5, 0};
    layers[2]->sketch.number = newSketchNumber();
    EXPECT_GT(std::abs(schedule.told(layers).error - before), 1e-3);
    expectSame();
}

// Beyond some number of layers their sum is made, and no products.
TEST(ToldError, OfManyLayersIsThatOfFew) {
    LayerSchedule::Layers few, many;
    const auto add = [](LayerSchedule::Layers& to, size_t count) {
        for (size_t i = 0; i < count; ++i) {
            const auto turn = static_cast<float>(i % 3);
            LayerSchedule::Layers one =
                layersOf(std::move(at(2, 2).noise(0, 1).off(0.2).sketch({{1, turn, 2}, {turn, 1, -turn}})));
            to.push_back(std::move(one.front()));
        }
    };
    add(few, 60);
    add(many, 120);
    EXPECT_NEAR(errorOf(many).error, errorOf(few).error, 1e-9) << "both have each as often";
}

TEST(ToldError, OfBouncesAddsUp) {
    EXPECT_NEAR(errorOf(layersOf(at(2, 2).off(0.02, 0.02), at(2, 2).off(0.04, 0.04))).error, 0.03, 1e-12);
}

TEST(ToldError, IsAllBeforeEachHasALevel) {
    EXPECT_EQ(errorOf(layersOf(at(2, 2).off(0.2), lit(2).off(0.1))).error, 1.0);
    EXPECT_FALSE(errorOf(layersOf(at(2, 2).off(0.001).converged(), lit(2).off(0.001).converged())).converged);
    EXPECT_FALSE(errorOf(layersOf(lit(2).converged()), {.samples = 64, .error = 0}).converged);
}

TEST(ToldError, LeavesOutWhatIsOff) {
    EXPECT_DOUBLE_EQ(errorOf(layersOf(at(2, 2).off(0.2), fresh().switchedOff())).error, 0.2);
    EXPECT_DOUBLE_EQ(errorOf(layersOf(at(2, 2).off(0.2), at(2, 2).off(0.9).switchedOff())).error, 0.2);
    EXPECT_TRUE(errorOf(layersOf(at(8, 8).off(0.001).converged(), at(2, 2).switchedOff())).converged);
}

TEST(ToldError, OfDarknessIsNothing) {
    EXPECT_EQ(errorOf({}).error, 0.0);
    EXPECT_TRUE(errorOf({}).converged);
    EXPECT_EQ(errorOf(layersOf(fresh().switchedOff())).error, 0.0);
    EXPECT_EQ(errorOf(layersOf(at(2, 2).off(0.5).shedding(0))).error, 0.0);
}

TEST(ToldError, ConvergesWithTheLastLayer) {
    EXPECT_TRUE(errorOf(layersOf(at(8, 8).off(0.005).converged(), at(8, 8).off(0.01).converged())).converged);
    EXPECT_FALSE(errorOf(layersOf(at(8, 8).off(0.005).converged(), at(8, 8).off(0.011))).converged);
}

TEST(ToldError, IsNotWhatWasAskedForWhereSamplesHaveRunOut) {
    EXPECT_FALSE(errorOf(layersOf(at(16, 4).off(0.05).converged()), {.samples = 64}).converged);
    EXPECT_TRUE(errorOf(layersOf(at(16, 4).off(0.05).converged()), {.samples = 64, .error = 0}).converged);
}

} // namespace
} // namespace relume
