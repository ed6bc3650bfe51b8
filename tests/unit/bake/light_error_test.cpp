#include "bake/base/light_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace relume {
namespace {

// Returns sums over so many patches whose three colours each have this mean and changed by this.
glm::dvec4 sumsOf(double change, double mean, double patches = 5) {
    return {3.0 * patches * change * change, 3.0 * patches * mean, patches, 0.0};
}

/// Light that comes by bounces, each of which adds so many times what the one before did.
struct Bounces {
    double ratio = 0.5;
    double change = 1, mean = 1; // of the last bounce, and so far

    double rest() const { return change * ratio / (1.0 - ratio) / mean; }
    void bounce() {
        change *= ratio;
        mean += change;
    }
};

BounceSeries seriesAfterTwo(Bounces& light) {
    BounceSeries series;
    series.learn(sumsOf(light.change, light.mean));
    light.bounce();
    series.learn(sumsOf(light.change, light.mean));
    return series;
}

TEST(RelativeError, IsTheRootOfVarianceOverTheMean) {
    // The mean of two patches' six colours is 2, their variance 0.04.
    EXPECT_DOUBLE_EQ(relativeError({.light = 12, .count = 2, .variance = 0.24}, 0), 0.1);
    EXPECT_DOUBLE_EQ(relativeError({.light = 120, .count = 20, .variance = 2.4}, 0), 0.1);
    EXPECT_DOUBLE_EQ(relativeError({.light = 24, .count = 2, .variance = 0.24}, 0), 0.05);
    EXPECT_DOUBLE_EQ(relativeError({.light = 12, .count = 2, .variance = 0.96}, 0), 0.2);
}

TEST(RelativeError, AddsBouncesThatAreToComeAsAnIndependentPart) {
    EXPECT_DOUBLE_EQ(relativeError({.light = 3, .count = 1, .variance = 3 * 0.03 * 0.03}, 0.04), 0.05);
    EXPECT_DOUBLE_EQ(relativeError({.light = 3, .count = 1, .variance = 0}, 0.04), 0.04);
}

TEST(RelativeError, LightThatIsNowhereIsOffByNothing) {
    EXPECT_EQ(relativeError({.light = 0, .count = 4, .variance = 1}, 0.5), 0.0);
    EXPECT_EQ(relativeError({}, 1), 0.0);
    EXPECT_EQ(relativeError({.light = -1, .count = 4, .variance = 1}, 0.5), 0.0);
}

TEST(BounceSeries, OneBounceTellsNothingButTheMean) {
    BounceSeries series;
    EXPECT_DOUBLE_EQ(series.learn(sumsOf(0.25, 7)), 7.0);
    EXPECT_DOUBLE_EQ(series.change, 0.25);
    EXPECT_EQ(series.error, 1.0);
    EXPECT_EQ(series.bouncesTo(0.01, 1.0, 100), 1u);
}

TEST(BounceSeries, TellsTheRestOfAGeometricSeries) {
    for (const double ratio : {0.05, 0.3, 0.5, 0.9, 0.99}) {
        Bounces light{.ratio = ratio};
        BounceSeries series = seriesAfterTwo(light);
        for (int bounce = 0; bounce < 6; ++bounce) {
            EXPECT_NEAR(series.ratio, ratio, 1e-12);
            EXPECT_NEAR(series.error, light.rest(), 1e-12);
            EXPECT_NEAR(series.change, light.change, 1e-12);
            light.bounce();
            EXPECT_NEAR(series.learn(sumsOf(light.change, light.mean)), light.mean, 1e-12);
        }
    }
}

TEST(BounceSeries, NumberOfPatchesDoesNotCount) {
    BounceSeries few, many;
    for (const double change : {1.0, 0.5}) {
        few.learn(sumsOf(change, 3, 1));
        many.learn(sumsOf(change, 3, 1000));
    }
    EXPECT_NEAR(few.error, many.error, 1e-12);
}

TEST(BounceSeries, KnowsHowManyBouncesThereAreToAnAim) {
    for (const double ratio : {0.1, 0.3, 0.5, 0.8, 0.95}) {
        for (const double aim : {0.1, 0.01, 1e-4}) {
            Bounces light{.ratio = ratio};
            const BounceSeries series = seriesAfterTwo(light);
            uint32_t bounces = 0;
            for (double left = series.error; left > aim; left *= ratio)
                ++bounces;
            EXPECT_EQ(series.bouncesTo(aim, 1.0, 1000), std::max(1u, bounces)) << ratio << ", " << aim;
        }
    }
}

// A tenth of all patches stands in a room that has a thousandth of the light. Of the mean light next to
// nothing is left when most of the room's is still to come.
TEST(BounceSeries, ADarkRoomIsAskedByItself) {
    constexpr double kAim = 1e-3, kLocalAim = 2e-3, kRoom = 0.1;
    for (const double ratio : {0.5, 0.7, 0.75}) {
        Bounces outside{.ratio = 0.2, .change = 900, .mean = 1000}, room{.ratio = ratio};
        BounceSeries series;
        uint32_t bounces = 0, ofTheWhole = 0;
        const auto learn = [&] {
            const double change =
                std::sqrt((1 - kRoom) * outside.change * outside.change + kRoom * room.change * room.change);
            glm::dvec4 sums = sumsOf(change, (1 - kRoom) * outside.mean + kRoom * room.mean, 10);
            sums.w = 10 * ((1 - kRoom) * outside.change / outside.mean + kRoom * room.change / room.mean);
            series.learn(sums);
            outside.bounce();
            room.bounce();
            ++bounces;
            if (ofTheWhole == 0 && series.error <= kAim) ofTheWhole = bounces;
        };
        learn();
        while (!series.isWithin(kAim, kLocalAim)) {
            const uint32_t more = series.bouncesTo(kAim, kLocalAim, 1000);
            for (uint32_t i = 0; i < more; ++i)
                learn();
            ASSERT_LT(bounces, 100u);
        }
        EXPECT_LE(kRoom * room.rest(), kLocalAim) << ratio;
        EXPECT_GT(bounces, ofTheWhole + 2) << ratio << ": the mean light alone would have ended before";
    }
}

TEST(BounceSeries, TheFirstBounceTellsNoRelativeChange) {
    BounceSeries series;
    series.learn({1, 3, 1, 3}, true); // w is the light before
    EXPECT_EQ(series.localError, 1.0);
    series.learn({1, 3, 1, 0.5});
    EXPECT_EQ(series.localError, 1.0) << "one change says nothing of the next ones";
    series.learn({1, 3, 1, 0.1});
    EXPECT_LT(series.localError, 1.0);
}

TEST(BounceSeries, AfterThatManyBouncesTheAimIsReached) {
    for (const double ratio : {0.2, 0.6, 0.9}) {
        constexpr double kAim = 1e-3;
        Bounces light{.ratio = ratio};
        BounceSeries series = seriesAfterTwo(light);
        for (uint32_t more = series.bouncesTo(kAim, 1.0, 1000); more > 0; --more) {
            light.bounce();
            series.learn(sumsOf(light.change, light.mean));
        }
        EXPECT_LE(series.error, kAim) << ratio;
    }
}

TEST(BounceSeries, TakesOneMoreAtLeastAndNoMoreThanItMay) {
    Bounces light{.ratio = 0.9};
    const BounceSeries series = seriesAfterTwo(light);
    EXPECT_EQ(series.bouncesTo(10.0, 1.0, 8), 1u);
    EXPECT_EQ(series.bouncesTo(1e-9, 1.0, 8), 8u);
    EXPECT_EQ(series.bouncesTo(1e-9, 1.0, 1), 1u);
}

TEST(BounceSeries, WhatDoesNotFallIsLookedAtAfterEachBounce) {
    BounceSeries series;
    series.learn(sumsOf(1, 1));
    series.learn(sumsOf(1.5, 2));
    EXPECT_DOUBLE_EQ(series.ratio, 1.5);
    EXPECT_EQ(series.error, 1.0);
    EXPECT_EQ(series.bouncesTo(0.01, 1.0, 100), 1u);
}

TEST(BounceSeries, WhatDoesNotChangeHasConverged) {
    BounceSeries series;
    series.learn(sumsOf(0, 3));
    EXPECT_EQ(series.error, 0.0);
    EXPECT_EQ(series.ratio, 0.0);
    EXPECT_EQ(series.bouncesTo(0.01, 1.0, 100), 1u);
}

TEST(BounceSeries, DarknessHasConverged) {
    BounceSeries series;
    EXPECT_EQ(series.learn(sumsOf(0, 0)), 0.0);
    EXPECT_EQ(series.error, 0.0);
}

TEST(BounceSeries, WithoutPatchesThereIsNoLight) {
    BounceSeries series;
    EXPECT_EQ(series.learn({1, 1, 0, 0}), 0.0);
    EXPECT_EQ(series.change, 0.0);
    EXPECT_EQ(series.error, 0.0);
}

} // namespace
} // namespace relume
