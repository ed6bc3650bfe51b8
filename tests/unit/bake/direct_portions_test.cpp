#include "bake/links/direct_portions.h"

#include "bake/direct/point_trace.h"

#include <gtest/gtest.h>

namespace relume {

TEST(DirectPortions, SamplePassesAtOnceBeginAtMultiplesOfTheirNumber) {
    EXPECT_EQ(samplePassesAtOnce(0, 1), 1u);
    EXPECT_EQ(samplePassesAtOnce(0, 7), 4u);
    EXPECT_EQ(samplePassesAtOnce(0, 1000), kMostTogether);
    EXPECT_EQ(samplePassesAtOnce(4, 100), 4u);
    EXPECT_EQ(samplePassesAtOnce(7, 100), 1u);
    EXPECT_EQ(samplePassesAtOnce(3 * kMostTogether, 1000), kMostTogether);
    for (uint32_t first = 0; first < 2 * kMostTogether; ++first)
        for (uint32_t left = 1; left < 2 * kMostTogether; ++left) {
            const uint32_t count = samplePassesAtOnce(first, left);
            EXPECT_TRUE(count <= left && first % count == 0) << first << " " << left;
        }
}

} // namespace relume
