// Levels, as LayerSchedule decides on them: which is the first, the next, the last, and which one is enough.
#include "tests/unit/layer_facts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

std::string targetOf(const ScheduleRules& rules, auto&& facts) {
    const LayerSchedule::Layers layers = layersOf(std::forward<decltype(facts)>(facts));
    LayerSchedule(rules).apportion(layers);
    return textOf(LayerSchedule(rules).targetOf(*layers.front()));
}

std::string nextOf(auto&& facts) {
    return targetOf(offlineRules(), facts);
}

bool isEnough(const ScheduleRules& rules, auto&& facts) {
    const LayerSchedule::Layers layers = layersOf(std::forward<decltype(facts)>(facts));
    LayerSchedule(rules).apportion(layers);
    return layers.front()->plan.converged;
}

struct RangeOfLevels {
    const char* name;
    ScheduleRules rules;
    const char *first, *last;
};

constexpr RangeOfLevels kRanges[] = {
    {"NoLimit", {.samples = 0}, "2+2", "16384+4096"},
    {"WholePasses", {.samples = 64}, "2+2", "16+4"},
    {"AnOpenPassCounts", {.samples = 65}, "2+2", "17+5"},
    {"OneSample", {.samples = 1}, "1+1", "1+1"},
    {"OnePassOfPoints", {.samples = 4}, "1+1", "1+1"},
    {"TwoPassesOfPoints", {.samples = 8}, "2+1", "2+1"},
    {"TwoPassesOfLinks", {.samples = 32}, "2+2", "8+2"},
    {"DirectLightAlone", {.samples = 64, .passes = 1}, "2+0", "16+0"},
    {"DirectLightAloneWithoutLimit", {.passes = 1}, "2+0", "16384+0"},
    {"ABounce", {.samples = 64, .passes = 2}, "2+2", "16+4"},
    {"ManyLinksOfAPass", {.linksOfSamplePass = 128, .samples = 64}, "2+1", "16+1"},
    {"OneOfEach", {.pointsOfSamplePass = 1, .linksOfSamplePass = 1, .samples = 64}, "2+2", "64+64"},
};

class LayerRange : public testing::TestWithParam<RangeOfLevels> {};

TEST_P(LayerRange, HasAFirstAndALastLevel) {
    const LayerSchedule schedule(GetParam().rules);
    EXPECT_EQ(textOf(schedule.firstLevel()), GetParam().first);
    EXPECT_EQ(textOf(schedule.lastLevel()), GetParam().last);
}

INSTANTIATE_TEST_SUITE_P(Rules, LayerRange, testing::ValuesIn(kRanges), CaseName());

TEST(LayerLevels, TheFirstIsHastyWhereOthersFollow) {
    EXPECT_TRUE(LayerSchedule(offlineRules()).isHasty({2, 2}));
    EXPECT_TRUE(LayerSchedule({.samples = 32}).isHasty({2, 2}));
    EXPECT_TRUE(LayerSchedule({.passes = 1}).isHasty({2, 0}));
}

TEST(LayerLevels, TheOnlyOneIsNotHasty) {
    EXPECT_FALSE(LayerSchedule({.samples = 4}).isHasty({1, 1}));
    EXPECT_FALSE(LayerSchedule({.samples = 8}).isHasty({2, 1}));
}

TEST(LayerLevels, LaterOnesAreNotHasty) {
    for (const LayerLevel level : {LayerLevel{2, 3}, LayerLevel{3, 2}, LayerLevel{8, 2}, LayerLevel{0, 4}})
        EXPECT_FALSE(LayerSchedule(offlineRules()).isHasty(level)) << textOf(level);
}

TEST(LayerLevels, WhatHasNoneAimsAtTheFirst) {
    EXPECT_EQ(targetOf(offlineRules(), fresh()), "2+2");
    EXPECT_EQ(targetOf(offlineRules(), lit(2)), "2+2");
    EXPECT_EQ(targetOf({.samples = 4, .error = 0}, fresh()), "1+1");
}

// Samples' variance must fall to 0.95 / 4 of what it is: 8.4 sample passes in place of 2. Those of direct
// light are a power of two.
TEST(LayerLevels, NoiseOfDirectLightTakesPoints) {
    EXPECT_EQ(nextOf(at(2, 2).noise(1, 0)), "16+2");
}

TEST(LayerLevels, NoiseOfBouncesTakesLinks) {
    EXPECT_EQ(nextOf(at(2, 2).noise(0, 1)), "2+12");
}

TEST(LayerLevels, NoLevelHasMoreThanEightTimesTheLast) {
    EXPECT_EQ(nextOf(at(2, 2).noise(1, 0).off(0.5)), "16+2");
    EXPECT_EQ(nextOf(at(16, 2).noise(1, 0).off(0.5)), "128+2");
}

TEST(LayerLevels, WhatIsSoughtIsTheRestOfAnError) {
    // With r times the variance that is allowed there are 2 r / 0.95 sample passes: 5.9 here.
    const double sampled = 2.8e-4;
    EXPECT_EQ(nextOf(at(2, 2).noise(0, 1).off(std::sqrt(sampled))), "2+6");
    // Bounces may leave a fifth of the aim, and then 6.1 are wanted.
    EXPECT_EQ(nextOf(at(2, 2).noise(0, 1).off(std::sqrt(sampled + 4e-6), 2e-3)), "2+8");
    // Samples are expected to take nothing away of what bounces leave beyond that.
    EXPECT_EQ(nextOf(at(2, 2).noise(0, 1).off(std::sqrt(sampled + 1e-4), 1e-2)), "2+8");
    // They leave less than they may.
    EXPECT_EQ(nextOf(at(2, 2).noise(0, 1).off(std::sqrt(sampled + 1e-8), 1e-4)), "2+6");
}

TEST(LayerLevels, WhereBouncesAreAllTheErrorTheBetterPartDoubles) {
    EXPECT_EQ(nextOf(at(2, 2).noise(1, 0.1).off(0.02, 0.02)), "4+2");
    EXPECT_EQ(nextOf(at(2, 2).noise(1, 100).off(0.02, 0.02)), "2+4");
    EXPECT_EQ(nextOf(at(2, 2).noise(1, 0.1).off(0.02, 0.03)), "4+2");
}

TEST(LayerLevels, SixteenRaysCostAPassOfLinks) {
    EXPECT_EQ(nextOf(at(2, 2).rays({16})), "16+12");
}

TEST(LayerLevels, CheapPointsAreTakenRatherThanLinks) {
    EXPECT_EQ(nextOf(at(2, 2).rays({1})), "16+6");
}

TEST(LayerLevels, DearPointsAreTakenLessOften) {
    EXPECT_EQ(nextOf(at(2, 2).rays({128}).penumbra({1, 1, 1, 1})), "8+16");
}

// On a GPU picks take as long as three segments.
TEST(LayerLevels, RaysToPickedPolygonsCostMore) {
    ScheduleRules rules = offlineRules();
    rules.costs = kGpuLayerCosts;
    const auto wanted = [&](bool picks) {
        const LayerSchedule::Layers layers = layersOf(at(2, 2).rays({16}));
        layers[0]->parts[0].picks = picks;
        LayerSchedule(rules).apportion(layers);
        return textOf(LayerSchedule(rules).targetOf(*layers[0]));
    };
    EXPECT_EQ(wanted(false), "16+12");
    EXPECT_EQ(wanted(true), "8+12") << "fewer of them";
}

TEST(LayerLevels, RaysOfAllPartsCount) {
    EXPECT_EQ(nextOf(at(2, 2).rays({4, 0, 12})), "16+12");
}

TEST(LayerLevels, WhatHasNoRaysCostsAsOne) {
    EXPECT_EQ(nextOf(at(2, 2)), nextOf(at(2, 2).rays({1})));
    EXPECT_EQ(nextOf(at(2, 2).rays({0, 0})), nextOf(at(2, 2).rays({1})));
}

TEST(LayerLevels, OutsideOfPenumbraeAnEighthOfTheRaysIsTaken) {
    EXPECT_EQ(nextOf(at(2, 2).rays({128}).penumbra({0, 0, 0, 0})), nextOf(at(2, 2).rays({16})));
    EXPECT_EQ(nextOf(at(2, 2).rays({128}).penumbra({})), nextOf(at(2, 2).rays({128}).penumbra({1})));
}

TEST(LayerLevels, TheNextIsNeverBeyondTheLast) {
    EXPECT_EQ(targetOf({.samples = 12}, at(2, 1).noise(1, 0).off(0.5)), "3+1");
    EXPECT_EQ(targetOf({.samples = 96}, at(2, 2).noise(1, 1).off(0.5)), "8+6");
}

TEST(LayerLevels, WithDirectLightAloneThereAreNoLinks) {
    EXPECT_EQ(targetOf({.passes = 1}, at(2, 0).noise(1, 0)), "8+0");
}

TEST(LayerLevels, WithoutAnErrorAllSamplesComeAfterTheFirst) {
    EXPECT_EQ(targetOf({.samples = 64, .error = 0}, at(2, 2)), "16+4");
    EXPECT_EQ(targetOf({.samples = 64, .error = 0}, at(2, 2).off(0.0)), "16+4");
    EXPECT_EQ(targetOf({.samples = 64, .error = 0}, fresh()), "2+2");
}

TEST(LayerLevels, EachHasMoreThanTheOneBeforeUntilTheLast) {
    const LayerSchedule schedule({.samples = 4000, .error = 1e-6});
    const LayerSchedule::Layers layers = layersOf(at(2, 2).off(0.1));
    Layer* layer = layers.front().get();
    constexpr int kMany = 20;
    int levels = 1;
    for (; layer->level != schedule.lastLevel() && levels < kMany; ++levels) {
        schedule.apportion(layers);
        const LayerLevel before = layer->level, next = schedule.targetOf(*layer);
        EXPECT_GE(next.directSamplePasses, before.directSamplePasses);
        EXPECT_GE(next.linkSamplePasses, before.linkSamplePasses);
        ASSERT_NE(next, before);
        layer->level = next;
    }
    EXPECT_LT(levels, kMany);
    EXPECT_EQ(textOf(layer->level), "1000+250");
}

TEST(LayerLevels, AskingAgainGivesTheSame) {
    const LayerSchedule schedule(offlineRules());
    const LayerSchedule::Layers layers = layersOf(at(2, 2).rays({4}));
    schedule.apportion(layers);
    const LayerLevel once = schedule.targetOf(*layers.front());
    schedule.apportion(layers);
    EXPECT_EQ(schedule.targetOf(*layers.front()), once);
}

// What was forgotten comes back in the steps that it was made in, and the first of them is seen at once.
TEST(LayerRedo, BeginsWithTheFirstLevelWhereItsStepsDo) {
    EXPECT_EQ(nextOf(fresh().redo({16, 8}, {2, 16})), "2+2");
    EXPECT_EQ(nextOf(lit(1).redo({16, 8}, {2, 16})), "2+2");
    EXPECT_EQ(nextOf(lit(2).redo({16, 8}, {2, 16})), "2+2");
}

TEST(LayerRedo, GoesOnToTheLevelItHad) {
    EXPECT_EQ(nextOf(at(2, 2).redo({16, 8}, {2, 16})), "16+8");
    EXPECT_EQ(nextOf(at(2, 2).off(0.0001).redo({16, 8}, {2, 16})), "16+8");
}

TEST(LayerRedo, TakesAllOfItAtOnceWhereDirectLightIsThere) {
    EXPECT_EQ(nextOf(lit(16).redo({16, 8}, {2, 16})), "16+8");
    EXPECT_EQ(nextOf(lit(3).redo({16, 8}, {2, 16})), "16+8");
}

TEST(LayerRedo, TakesAllOfItAtOnceWithoutSteps) {
    EXPECT_EQ(nextOf(fresh().redo({16, 8})), "16+8");
    EXPECT_EQ(nextOf(lit(2).redo({16, 8})), "16+8");
}

TEST(LayerRedo, TakesAllOfItAtOnceWhereStepsBeginOtherwise) {
    EXPECT_EQ(nextOf(fresh().redo({16, 8}, {4, 16})), "16+8");
    EXPECT_EQ(nextOf(fresh().redo({16, 8}, {1, 2, 16})), "16+8");
}

TEST(LayerRedo, OfTheFirstLevelIsTheFirstLevel) {
    EXPECT_EQ(nextOf(fresh().redo({2, 2}, {2})), "2+2");
    EXPECT_EQ(nextOf(lit(2).redo({2, 2}, {2})), "2+2");
}

TEST(LayerRedo, KnowsTheFirstLevelOfFewSamples) {
    EXPECT_EQ(targetOf({.samples = 4}, fresh().redo({1, 1}, {1})), "1+1");
    EXPECT_EQ(targetOf({.samples = 4}, fresh().redo({16, 8}, {1, 16})), "1+1");
    EXPECT_EQ(targetOf({.samples = 4}, fresh().redo({16, 8}, {2, 16})), "16+8");
}

TEST(LayerConverges, WhereTheErrorIsWhatWasAskedFor) {
    EXPECT_TRUE(isEnough(offlineRules(), at(8, 8).off(0.01)));
    EXPECT_TRUE(isEnough(offlineRules(), at(8, 8).off(0.005)));
    EXPECT_FALSE(isEnough(offlineRules(), at(8, 8).off(0.01001)));
    EXPECT_FALSE(isEnough({.error = 0.001}, at(8, 8).off(0.005)));
}

TEST(LayerConverges, WithTheLastSampleWhateverTheError) {
    EXPECT_TRUE(isEnough({.samples = 64}, at(16, 4).off(0.5)));
    EXPECT_FALSE(isEnough({.samples = 64}, at(16, 3).off(0.5)));
    EXPECT_FALSE(isEnough({.samples = 64}, at(15, 4).off(0.5)));
}

TEST(LayerConverges, WithoutAnErrorOnlyWithTheLastSample) {
    EXPECT_FALSE(isEnough({.samples = 64, .error = 0}, at(8, 4).off(0.0)));
    EXPECT_FALSE(isEnough({.samples = 64, .error = -1}, at(8, 4).off(0.0)));
    EXPECT_TRUE(isEnough({.samples = 64, .error = 0}, at(16, 4).off(0.2)));
}

TEST(LayerConverges, WhatLightsNothingIsDone) {
    EXPECT_TRUE(isEnough(offlineRules(), at(2, 2).off(0.5).shedding(0)));
    EXPECT_TRUE(isEnough({.samples = 64, .error = 0}, at(2, 2).shedding(0)));
    EXPECT_FALSE(isEnough(offlineRules(), at(2, 2).off(0.5).shedding(1e-9)));
}

TEST(LayerConverges, NotBeforeItIsWhereItWas) {
    EXPECT_FALSE(isEnough(offlineRules(), at(2, 2).off(0.005).redo({16, 8})));
    EXPECT_FALSE(isEnough({.samples = 64}, at(16, 4).redo({16, 4})));
    EXPECT_FALSE(isEnough(offlineRules(), at(2, 2).shedding(0).redo({16, 8})));
}

} // namespace
} // namespace relume
