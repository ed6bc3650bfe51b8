// How large a lightmap is made for a level whose user names no size.
#include "app/edit/prepare.h"

#include "assets/atlas/unwrap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace relume {
namespace {

const std::string kRoom = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_small.glb";

PreparedScene fitted(double density, std::vector<uint32_t>& asked, uint32_t allowed) {
    return prepareScene({.path = kRoom,
                         .size = 64,
                         .leastDensity = density,
                         .fitting = [&asked, allowed](const Scene&, LightmapPages pages, uint32_t edge) {
                             EXPECT_EQ(pages.count, 1u);
                             asked.push_back(edge);
                             return std::min(edge, allowed);
                         }});
}

TEST(Prepare, MakesALightmapOfTheDensityThatIsWanted) {
    std::vector<uint32_t> asked;
    EXPECT_EQ(fitted(0, asked, 8192).size, 64u) << "none is wanted";
    const double least = 1.0, most = 32.0;
    uint32_t before = 64;
    for (double density = least; density <= most; density *= 2) {
        const PreparedScene room = fitted(density, asked, 8192);
        EXPECT_GE(room.size, before);
        EXPECT_EQ(room.size & (room.size - 1), 0u) << "a power of two";
        EXPECT_GE(room.size * std::sqrt(0.85 / surfaceArea(room.scene)), density) << "charts cover 85 %";
        before = room.size;
    }
    EXPECT_GT(before, 64u);
    EXPECT_FALSE(asked.empty());
}

TEST(Prepare, MakesNoLargerOneThanMemoryAllows) {
    std::vector<uint32_t> asked;
    EXPECT_EQ(fitted(32.0, asked, 128).size, 128u);
    ASSERT_EQ(asked.size(), 1u);
    EXPECT_GT(asked.front(), 128u);
    EXPECT_EQ(fitted(1e6, asked, 64).size, 64u);
    EXPECT_EQ(asked.back(), kMaxPageSize) << "no more is ever wanted";
}

} // namespace
} // namespace relume
