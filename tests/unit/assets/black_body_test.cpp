#include "assets/model/black_body.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace relume {
namespace {

// Returns the chromaticity from Planck's law and the CIE 1931 observer, by the fits of [Wyman, Sloan and
// Shirley 2013, Simple Analytic Approximations to the CIE XYZ Color Matching Functions], as linear sRGB with
// its largest channel at 1.
glm::dvec3 integrated(double kelvin) {
    const auto lobe = [](double x, double middle, double left, double right) {
        const double t = (x - middle) * (x < middle ? left : right);
        return std::exp(-0.5 * t * t);
    };
    glm::dvec3 xyz(0.0);
    for (double nm = 380; nm < 780; nm += 1) {
        const double metres = nm * 1e-9;
        const double power = std::pow(metres, -5) / (std::exp(1.438776877e-2 / (metres * kelvin)) - 1.0);
        xyz.x += power * (1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
                          0.065 * lobe(nm, 501.1, 0.0490, 0.0382));
        xyz.y += power * (0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322));
        xyz.z += power * (1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725));
    }
    const glm::dvec3 rgb(3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
                         -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
                         0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z);
    return glm::max(rgb, 0.0) / std::max({rgb.r, rgb.g, rgb.b});
}

TEST(BlackBody, IsWhatPlancksLawGives) {
    for (const double kelvin : {1200.0, 1900.0, 2700.0, 4000.0, 5500.0, 6500.0, 9000.0, 14000.0}) {
        const glm::dvec3 wanted = integrated(kelvin);
        const glm::vec3 color = blackBody(static_cast<float>(kelvin));
        // The observer's fit is good to a hundredth.
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(color[c], wanted[c], 0.02) << kelvin << " K, channel " << c;
    }
}

TEST(BlackBody, StaysWithinItsRange) {
    EXPECT_EQ(blackBody(-5.0f), blackBody(kLowestTemperature));
    EXPECT_EQ(blackBody(1e9f), blackBody(kHighestTemperature));
    EXPECT_EQ(blackBody(1000.0f).b, 0.0f);
}

TEST(BlackBody, ItsTemperatureIsFoundAgain) {
    for (const float kelvin : {1000.0f, 1500.0f, 2700.0f, 6500.0f, 10000.0f, 14900.0f}) {
        const std::optional<NearestBody> found = nearestBlackBody(37.0f * blackBody(kelvin));
        ASSERT_TRUE(found) << kelvin;
        EXPECT_NEAR(found->kelvin, kelvin, 0.002f * kelvin);
        EXPECT_LT(found->off, 1e-3f);
    }
}

TEST(BlackBody, OtherColoursAreOff) {
    EXPECT_GT(nearestBlackBody({0.1f, 1.0f, 0.1f})->off, 0.2f);
    EXPECT_GT(nearestBlackBody({1.0f, 0.1f, 1.0f})->off, 0.2f);
    EXPECT_FALSE(nearestBlackBody(glm::vec3(0.0f)));
    EXPECT_FALSE(nearestBlackBody({1.0f, std::nanf(""), 1.0f}));
}

} // namespace
} // namespace relume
