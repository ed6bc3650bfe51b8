#include "app/text/heat_map.h"
#include "renderer/shader_types.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(HeatMap, GetsEverBrighter) {
    double before = -1;
    for (int i = 0; i <= 100; ++i) {
        const glm::vec3 c = heatColour(i / 100.0);
        const double luma = 0.30 * c.r + 0.59 * c.g + 0.11 * c.b; // the weights the ramp is made for
        EXPECT_GT(luma, before) << i;
        before = luma;
    }
    EXPECT_EQ(heatColour(-1.0), glm::vec3(0.0f));
    EXPECT_EQ(heatColour(7.0), glm::vec3(1.0f));
}

// The viewer's scale is that of the pictures on disk.
TEST(HeatMap, IsTheShadersScale) {
    for (int i = 0; i <= 100; ++i) {
        const glm::vec3 a = heatColour(i / 100.0), b = shader::heatColor(static_cast<float>(i) / 100.0f);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(a[c], b[c], 1e-4f) << i << " " << c;
    }
}

TEST(HeatMap, EndsItsScaleAtASamplePassNumber) {
    const std::vector<bool> all(4, true);
    EXPECT_DOUBLE_EQ(heatScale({0.0f, 0.013f, 0.0f, 0.0f}, all), 0.02); // alone, but all there is
    EXPECT_DOUBLE_EQ(heatScale({0.2f, 0.3f, 0.4f, 0.31f}, all), 0.5);
    EXPECT_DOUBLE_EQ(heatScale({2.0f, 2.0f, 2.0f, 2.0f}, all), 2.0);
    EXPECT_DOUBLE_EQ(heatScale({700.0f, 700.0f, 700.0f, 1.0f}, all), 1000.0);
    EXPECT_DOUBLE_EQ(heatScale({0.0f, 0.0f, 0.0f, 0.0f}, all), 1.0);
    EXPECT_DOUBLE_EQ(heatScale({9.0f, 0.3f, 9.0f, 9.0f}, {false, true, false, false}), 0.5);
    EXPECT_DOUBLE_EQ(heatScale({1.0f}, {false}), 1.0);
    std::vector<float> spread(1000, 0.4f);
    spread[7] = 90.0f; // an outlier
    EXPECT_DOUBLE_EQ(heatScale(spread, std::vector<bool>(1000, true)), 0.5);
}

TEST(HeatMap, ShowsUncoveredTexelsGrey) {
    const FloatImage map = heatMap(2, {0.0f, 5.0f, 5.0f, 9.0f}, {true, false, true, true}, 5.0);
    ASSERT_EQ(map.height, 2u);
    for (const auto& plane : map.planes) {
        EXPECT_EQ(plane[0], 0.0f);
        EXPECT_EQ(plane[1], map.planes[0][1]);
        EXPECT_EQ(plane[2], 1.0f);
        EXPECT_EQ(plane[3], 1.0f);
    }
    EXPECT_GT(map.planes[0][1], 0.0f);
    EXPECT_LT(map.planes[0][1], 1.0f);
}

} // namespace
} // namespace relume
