#include "app/frames_bench.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(RayCount, GoesOnFromBakeToBake) {
    RayCount count;
    EXPECT_EQ(count.total(), 0u);
    for (const uint64_t rays : {100u, 100u, 250u})
        count.see(rays);
    EXPECT_EQ(count.total(), 250u);
    count.see(30); // the next bake
    EXPECT_EQ(count.total(), 280u);
    count.see(70);
    count.see(0);
    count.see(5);
    EXPECT_EQ(count.total(), 325u);
}

} // namespace
} // namespace relume
