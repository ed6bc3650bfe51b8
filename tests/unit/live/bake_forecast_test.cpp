#include "app/live/bake_forecast.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

TEST(BakeForecast, AnErrorThatFallsByTheRootOfTimeNeedsFourTimesAsLongForHalf) {
    std::vector<ConvergencePoint> history;
    for (int i = 1; i <= 64; ++i)
        history.push_back({0.1 * i, 0.2 / std::sqrt(0.1 * i)});
    const double now = history.back().seconds;
    EXPECT_NEAR(secondsUntil(history, 0.5 * history.back().error), 3.0 * now, 1e-6 * now);
}

TEST(BakeForecast, SaysNothingWhereNothingCanBeTold) {
    const std::vector<ConvergencePoint> one = {{1.0, 0.1}};
    const std::vector<ConvergencePoint> rising = {{1.0, 0.1}, {2.0, 0.2}};
    EXPECT_LT(secondsUntil({}, 0.01), 0);
    EXPECT_LT(secondsUntil(one, 0.01), 0);
    EXPECT_LT(secondsUntil(rising, 0.01), 0);
    EXPECT_LT(secondsUntil(rising, 0.0), 0) << "no aim";
    EXPECT_EQ(secondsUntil(rising, 0.3), 0) << "is there already";
}

TEST(RayMeter, FollowsAChangeWithinItsWindow) {
    RayMeter meter;
    EXPECT_EQ(meter.perSecond(), 0.0);
    uint64_t rays = 0;
    double seconds = 0;
    for (int i = 0; i < 100; ++i)
        meter.add(seconds += 0.1, rays += 100);
    EXPECT_NEAR(meter.perSecond(), 1000.0, 1.0);
    for (int i = 0; i < 30; ++i)
        meter.add(seconds += 0.1, rays += 300);
    EXPECT_NEAR(meter.perSecond(), 3000.0, 1.0) << "what was before the window is forgotten";
    meter.add(seconds, 0);
    EXPECT_EQ(meter.perSecond(), 0.0) << "another bake begins";
}

} // namespace
} // namespace relume
