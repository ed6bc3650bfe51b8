#include "bake/base/series.h"

#include <gtest/gtest.h>

#include <limits>

namespace relume {

TEST(Series, TheRestOfAGeometricSeriesIsItsTail) {
    for (const double ratio : {0.05, 0.4, 0.9}) {
        double change = 3, before = 0, tail = 0;
        for (double term = change * ratio; term > 1e-18; term *= ratio)
            tail += term;
        for (int bounce = 0; bounce < 5; ++bounce) {
            constexpr double kMean = 7;
            const std::optional<SeriesRest> rest = seriesRest(before, change, kMean);
            ASSERT_EQ(rest.has_value(), bounce > 0) << "one change tells no ratio";
            if (rest) {
                EXPECT_NEAR(rest->ratio, ratio, 1e-12);
                EXPECT_NEAR(rest->error, tail / kMean, 1e-12);
            }
            before = change;
            change *= ratio;
            tail -= change;
        }
    }
}

TEST(Series, WhatDoesNotChangeOrReachesNothingHasNoRest) {
    EXPECT_EQ(seriesRest(0, 0, 1)->error, 0.0);
    EXPECT_EQ(seriesRest(2, 0, 1)->error, 0.0);
    EXPECT_EQ(seriesRest(2, 0, 1)->ratio, 0.0);
    EXPECT_EQ(seriesRest(2, 1, 0)->error, 0.0);
}

TEST(Series, WhatDoesNotFallIsWhollyOpen) {
    EXPECT_EQ(seriesRest(1, 1, 5)->error, 1.0);
    EXPECT_EQ(seriesRest(1, 2, 5)->error, 1.0);
    EXPECT_EQ(seriesRest(1, 2, 5)->ratio, 2.0);
    EXPECT_EQ(seriesRest(1, std::numeric_limits<double>::infinity(), 5)->error, 1.0);
}

} // namespace relume
