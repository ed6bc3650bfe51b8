// How far layers go by their share of the composite, as LayerSchedule decides on it.
#include "tests/unit/layer_facts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

constexpr ScheduleRules kComposite = {.error = 0.01, .together = true};

// Returns the levels that are wanted of layers, "8+2 done" of one that needs none.
std::string wantedOf(const LayerSchedule::Layers& layers, const ScheduleRules& rules = kComposite) {
    LayerSchedule(rules).apportion(layers, true);
    std::string text;
    for (const std::unique_ptr<Layer>& layer : layers)
        text +=
            (text.empty() ? "" : ", ") + textOf(layer->plan.wanted) + (layer->plan.converged ? " done" : "");
    return text;
}

LayerFacts direct(double error) {
    return std::move(at(2, 2).noise(1, 0).off(error));
}

TEST(LayerShares, AllAreDoneWhereTheCompositeIs) {
    EXPECT_EQ(wantedOf(layersOf(direct(0.005), direct(0.015))), "2+2 done, 2+2 done");
}

// The mean light may be as good as is asked for while dark places lack bounces.
TEST(LayerShares, WhatBouncedInHasteGoesOn) {
    const auto hasty = [] { return std::move(direct(0.005).hasty()); };
    EXPECT_EQ(wantedOf(layersOf(hasty(), direct(0.005))), "2+3, 2+2 done");
    EXPECT_EQ(wantedOf(layersOf(hasty(), direct(0.04))), "2+3, 8+2");
    EXPECT_EQ(wantedOf(layersOf(hasty().switchedOff(), direct(0.005))), "2+2 done, 2+2 done");
    // There are no more links to go on with, so that all points are taken.
    const ScheduleRules few = {.samples = 32, .error = 0.01, .together = true};
    EXPECT_EQ(wantedOf(layersOf(hasty()), few), "8+2");
}

TEST(LayerShares, WhatAddsNothingIsNotMadeBetter) {
    EXPECT_EQ(wantedOf(layersOf(direct(0.02), direct(0.02).weighing(0.01f))), "8+2, 2+2 done");
    EXPECT_EQ(wantedOf(layersOf(direct(0.02), direct(0.02).switchedOff())), "8+2, 2+2 done");
}

TEST(LayerShares, TheDearerOneTakesFewerSamples) {
    EXPECT_EQ(wantedOf(layersOf(direct(0.02).rays({1}), direct(0.02).rays({64}))), "8+2, 4+2");
}

// Links are traced once for both.
TEST(LayerShares, LinksCostLessWhereOthersShareThem) {
    const auto lamp = [] { return std::move(at(2, 2).noise(1, 1).off(0.014).rays({64})); };
    const auto dark = [] { return std::move(at(2, 2).shedding(1).weighing(1e-6f)); };
    const LayerSchedule::Layers alone = layersOf(lamp()), many = layersOf(lamp(), dark(), dark(), dark());
    EXPECT_EQ(wantedOf(alone), "4+6");
    EXPECT_EQ(wantedOf(many), "4+8, 2+2 done, 2+2 done, 2+2 done");
}

// The composite is off by less than .01, each by more; alone it needs (.012 / .01)^2 / .95 times the samples.
TEST(LayerShares, WhatIsSoloedGoesOn) {
    const LayerSchedule::Layers layers = layersOf(direct(0.012), direct(0.012));
    EXPECT_EQ(wantedOf(layers), "2+2 done, 2+2 done");
    layers[1]->source.weight = glm::vec3(0.0f);
    EXPECT_EQ(wantedOf(layers), "4+2, 2+2 done");
    layers[1]->source.weight = glm::vec3(1.0f);
    EXPECT_EQ(wantedOf(layers), "2+2 done, 2+2 done");
}

TEST(LayerShares, EachHasItsOwnErrorWhereThatIsAsked) {
    const ScheduleRules both = {.error = 0.01, .layerError = 0.01};
    EXPECT_EQ(wantedOf(layersOf(direct(0.005), direct(0.0142)), both), "2+2 done, 8+2");
    EXPECT_EQ(wantedOf(layersOf(direct(0.005), direct(0.01)), both), "2+2 done, 2+2 done");
}

// What comes of the first says nothing yet: the second has its level, too.
TEST(LayerShares, LevelsOfAllAreDecidedAtOnce) {
    const LayerSchedule schedule(kComposite);
    const LayerSchedule::Layers layers = layersOf(direct(0.04), direct(0.04));
    EXPECT_EQ(wantedOf(layers), "8+2, 8+2");
    layers[0]->level = {8, 2};
    layers[0]->error = 0.0001;
    layers[1]->error = 0.01;
    schedule.apportion(layers);
    EXPECT_EQ(textOf(layers[1]->plan.wanted), "8+2");
    EXPECT_FALSE(layers[1]->plan.converged);
    schedule.apportion(layers, true);
    EXPECT_TRUE(layers[1]->plan.converged);
}

// Half the local error is half the error, which takes four times as many sample passes.
TEST(LayerShares, ALocalErrorOutOfReachTakesMoreOfAll) {
    ScheduleRules rules = kComposite;
    rules.localError = 0.05;
    const LayerSchedule schedule(rules);
    const auto wanted = [&](std::optional<double> local) {
        const LayerSchedule::Layers layers = layersOf(direct(0.005), direct(0.005));
        const CompositeLocal off{.error = local.value_or(0), .worths = {}};
        schedule.apportion(layers, false, local ? &off : nullptr);
        return textOf(layers[0]->plan.wanted) + ", " + textOf(layers[1]->plan.wanted);
    };
    EXPECT_EQ(wanted(0.05), "2+2, 2+2");
    EXPECT_EQ(wanted(std::nullopt), "2+2, 2+2") << "it is not known yet";
    EXPECT_EQ(wanted(0.06), "4+2, 4+2");
    EXPECT_EQ(wanted(0.1), "8+2, 8+2");
}

// The first layer has most of the variance, where it is bright; the second has what makes the local error.
TEST(LayerShares, ALocalErrorTakesSamplesWhereItIsMade) {
    const ScheduleRules rules = {.error = 0.01, .localError = 0.05};
    const LayerSchedule::Layers layers = layersOf(direct(0.008), direct(0.002));
    const CompositeLocal off{.error = 0.1, .worths = {{.direct = 0.001}, {.direct = 1}}};
    LayerSchedule(rules).apportion(layers, false, &off);
    EXPECT_EQ(textOf(layers[0]->plan.wanted), "2+2");
    EXPECT_EQ(textOf(layers[1]->plan.wanted), "8+2");
}

TEST(LayerShares, TheLocalErrorAloneMayBeAskedFor) {
    const ScheduleRules rules = {.error = 0, .localError = 0.05};
    const LayerSchedule schedule(rules);
    const LayerSchedule::Layers layers = layersOf(direct(0.2));
    const CompositeLocal far{.error = 0.06, .worths = {}}, near{.error = 0.04, .worths = {}};
    schedule.apportion(layers, false, &far);
    EXPECT_EQ(textOf(layers[0]->plan.wanted), "4+2");
    schedule.apportion(layers, true, &near);
    EXPECT_EQ(textOf(layers[0]->plan.wanted), "2+2");
    EXPECT_TRUE(schedule.told(layers, 0.04).converged);
    EXPECT_FALSE(schedule.told(layers, 0.06).converged);
    EXPECT_FALSE(schedule.told(layers).converged);
}

TEST(LayerShares, LayersAreTogetherOnceEachHasWhatItWasToHave) {
    const LayerSchedule schedule(kComposite);
    const LayerSchedule::Layers layers = layersOf(direct(0.04), direct(0.04));
    EXPECT_TRUE(schedule.areTogether(layers));
    schedule.apportion(layers);
    EXPECT_FALSE(schedule.areTogether(layers));
    layers[0]->level = layers[0]->plan.wanted;
    EXPECT_FALSE(schedule.areTogether(layers));
    layers[1]->level = layers[1]->plan.wanted;
    EXPECT_TRUE(schedule.areTogether(layers));
    layers[1]->redo = LayerLevel{2, 2};
    EXPECT_FALSE(schedule.areTogether(layers));
    EXPECT_FALSE(schedule.areTogether(layersOf(direct(0.04), fresh())));
    EXPECT_TRUE(schedule.areTogether(layersOf(direct(0.04), fresh().switchedOff())));
}

TEST(LayerShares, NothingIsDecidedBeforeEachHasALevel) {
    EXPECT_EQ(wantedOf(layersOf(direct(0.04), fresh())), "2+2 done, 0+0");
}

TEST(LayerShares, WhatLacksBouncesIsMadeAnew) {
    EXPECT_EQ(wantedOf(layersOf(at(2, 2).noise(1, 0.1).off(0.05, 0.05), direct(0.001))), "4+2, 2+2 done");
}

TEST(LayerShares, SomeLayerGoesOnUntilTheErrorIsReached) {
    const LayerSchedule schedule(kComposite);
    const LayerSchedule::Layers layers =
        layersOf(at(2, 2).noise(1, 3).off(0.5), at(2, 2).noise(3, 1).off(0.1).weighing(0.2f), direct(0.9));
    constexpr int kMany = 60;
    int steps = 0;
    for (bool more = true; more && steps < kMany; ++steps) {
        schedule.apportion(layers);
        more = false;
        for (const std::unique_ptr<Layer>& layer : layers) {
            const LayerLevel now = layer->level, next = layer->plan.wanted;
            EXPECT_EQ(layer->plan.converged, next == now);
            EXPECT_GE(next.directSamplePasses, now.directSamplePasses);
            EXPECT_GE(next.linkSamplePasses, now.linkSamplePasses);
            more = more || next != now;
            const double before = layer->directVariance + layer->indirectVariance;
            layer->directVariance *= double(now.directSamplePasses) / next.directSamplePasses;
            layer->indirectVariance *= double(now.linkSamplePasses) / next.linkSamplePasses;
            layer->error *= std::sqrt((layer->directVariance + layer->indirectVariance) / before);
            layer->level = next;
        }
    }
    EXPECT_LT(steps, kMany);
    EXPECT_TRUE(schedule.told(layers).converged);
}

} // namespace
} // namespace relume
