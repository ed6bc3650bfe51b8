#include "bake/base/bounce_convergence.h"

#include <gtest/gtest.h>

namespace relume {

TEST(BounceConvergence, AGeometricSeriesIsTold) {
    BounceConvergence convergence;
    double mean = 0, gain = 2;
    convergence.add(mean);
    EXPECT_EQ(convergence.left, 1.0);
    for (int bounce = 0; bounce < 6; ++bounce, gain *= 0.4) {
        mean += gain;
        convergence.add(mean);
        const double end = 2 / (1 - 0.4);
        EXPECT_NEAR(convergence.left, bounce == 0 ? 1.0 : (end - mean) / mean, 1e-9);
    }
    const double left = convergence.left;
    convergence.bounce();
    EXPECT_NEAR(convergence.left, 0.4 * left, 1e-9);
    // This is the mean of a sample pass that lacks 10 % and one that goes on from it and lacks 4 %.
    convergence.left = 0.1;
    convergence.samplePass(1);
    EXPECT_NEAR(convergence.left, 0.07, 1e-9);
}

TEST(BounceConvergence, NothingIsLeftOfWhatDoesNotGrow) {
    BounceConvergence dark;
    dark.add(0);
    dark.add(0);
    EXPECT_EQ(dark.left, 0.0);
    BounceConvergence growing;
    growing.add(0);
    growing.add(1);
    growing.add(3);
    EXPECT_EQ(growing.left, 1.0);
}

} // namespace relume
