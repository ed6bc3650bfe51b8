#include "app/bench/frames_bench.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(RayCount, GoesOnFromBakeToBake) {
    RayCount count;
    EXPECT_EQ(count.total(), 0u);
    for (const uint64_t rays : {100u, 100u, 250u})
        count.see(1, rays);
    EXPECT_EQ(count.total(), 250u);
    count.see(2, 30);
    EXPECT_EQ(count.total(), 280u);
    count.see(4, 30); // all of one, and none seen of the one before
    EXPECT_EQ(count.total(), 310u);
    count.see(5, 0);
    count.see(5, 5);
    EXPECT_EQ(count.total(), 315u);
}

} // namespace
} // namespace relume
