#include "bake/base/settling.h"

#include <gtest/gtest.h>

namespace relume {

TEST(Settling, AGeometricSeriesIsTold) {
    Settling settling;
    double mean = 0, gain = 2;
    settling.add(mean);
    EXPECT_EQ(settling.left, 1.0);
    for (int bounce = 0; bounce < 6; ++bounce, gain *= 0.4) {
        mean += gain;
        settling.add(mean);
        const double end = 2 / (1 - 0.4);
        EXPECT_NEAR(settling.left, bounce == 0 ? 1.0 : (end - mean) / mean, 1e-9);
    }
    const double left = settling.left;
    settling.bounce();
    EXPECT_NEAR(settling.left, 0.4 * left, 1e-9);
    // This is the mean of a sample pass that lacks 10 % and one that goes on from it and lacks 4 %.
    settling.left = 0.1;
    settling.round(1);
    EXPECT_NEAR(settling.left, 0.07, 1e-9);
}

TEST(Settling, NothingIsLeftOfWhatDoesNotGrow) {
    Settling dark;
    dark.add(0);
    dark.add(0);
    EXPECT_EQ(dark.left, 0.0);
    Settling growing;
    growing.add(0);
    growing.add(1);
    growing.add(3);
    EXPECT_EQ(growing.left, 1.0);
}

} // namespace relume
