#include "assets/black_body.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

// Chromaticity of a linear sRGB colour [IEC 61966-2-1].
glm::vec2 chromaticity(const glm::vec3& rgb) {
    const glm::vec3 xyz(0.4124f * rgb.r + 0.3576f * rgb.g + 0.1805f * rgb.b,
                        0.2126f * rgb.r + 0.7152f * rgb.g + 0.0722f * rgb.b,
                        0.0193f * rgb.r + 0.1192f * rgb.g + 0.9505f * rgb.b);
    return glm::vec2(xyz) / (xyz.x + xyz.y + xyz.z);
}

// Points of the Planckian locus as the CIE has them: illuminant A, and 4000, 6500 and 10000 K.
TEST(BlackBody, HasTheChromaticityOfThePlanckianLocus) {
    const struct {
        float kelvin, x, y;
    } points[] = {{2856, 0.4476f, 0.4074f},
                  {4000, 0.3805f, 0.3768f},
                  {6500, 0.3135f, 0.3237f},
                  {10000, 0.2807f, 0.2884f}};
    for (const auto& point : points) {
        const glm::vec2 xy = chromaticity(blackBodyColor(point.kelvin));
        EXPECT_NEAR(xy.x, point.x, 0.002f) << point.kelvin; // what the fitted functions are off by
        EXPECT_NEAR(xy.y, point.y, 0.002f) << point.kelvin;
    }
}

TEST(BlackBody, GetsBluerWithTheTemperatureAndNeverBrighter) {
    float before = -1.0f;
    for (float kelvin = kColdestBlackBody; kelvin <= kHottestBlackBody; kelvin *= 1.1f) {
        const glm::vec3 color = blackBodyColor(kelvin);
        EXPECT_EQ(std::max({color.r, color.g, color.b}), 1.0f);
        EXPECT_GE(std::min({color.r, color.g, color.b}), 0.0f);
        const float blue = color.b / color.r;
        EXPECT_GE(blue, before);
        before = blue;
    }
    EXPECT_EQ(blackBodyColor(1500.0f).b, 0.0f); // outside the gamut
}

} // namespace
} // namespace relume
