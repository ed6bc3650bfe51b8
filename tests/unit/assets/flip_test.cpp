#include "assets/images/flip.h"

#include <cmath>
#include <functional>
#include <numeric>

#include <gtest/gtest.h>

namespace relume {
namespace {

using Pixel = std::function<glm::vec3(uint32_t x, uint32_t y)>;

std::vector<glm::vec3> picture(uint32_t width, uint32_t height, const Pixel& pixel) {
    std::vector<glm::vec3> pixels;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            pixels.push_back(pixel(x, y));
    return pixels;
}

std::vector<glm::vec3> flat(uint32_t width, uint32_t height, const glm::vec3& colour) {
    return picture(width, height, [&](uint32_t, uint32_t) { return colour; });
}

// Returns uniform noise in [0, 1) of a linear congruential generator, a value per channel in texel order.
std::vector<glm::vec3> noise(uint32_t width, uint32_t height, uint32_t seed) {
    const auto next = [&] {
        seed = seed * 1664525u + 1013904223u;
        return static_cast<float>(seed >> 8) / 16777216.0f;
    };
    return picture(width, height, [&](uint32_t, uint32_t) {
        const float r = next(), g = next();
        return glm::vec3(r, g, next());
    });
}

FlipInput input(uint32_t width, uint32_t height, std::vector<glm::vec3> a, std::vector<glm::vec3> b) {
    return {width, height, std::move(a), std::move(b),
            std::vector<bool>(static_cast<size_t>(width) * height, true)};
}

double mean(const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST(Flip, IsZeroForEqualPictures) {
    for (const auto& same : {flat(40, 30, glm::vec3(0.3f)), noise(40, 30, 5)}) {
        for (float value : flip(input(40, 30, same, same)))
            EXPECT_EQ(value, 0.0f);
    }
}

// Flat pictures pass the filters unchanged and have no features; what remains are the paper's formulas.
TEST(Flip, FollowsTheFormulasOnFlatPictures) {
    const auto between = [](const glm::vec3& a, const glm::vec3& b) {
        return flip(input(33, 21, flat(33, 21, a), flat(33, 21, b))).at(10 * 33 + 16);
    };
    // Green and blue are the largest difference there is.
    EXPECT_NEAR(between({0, 1, 0}, {0, 0, 1}), 1.0, 1e-4);
    // In CIELAB, sRGB's green is (87.73, -86.18, 83.18) and its blue (32.30, 79.19, -107.86); with Hunt's
    // effect they are 55.44 + |(-75.61 - 25.58, 72.98 + 34.84)| apart, black and white 100.
    const double largest = std::pow(55.44 + std::hypot(75.61 + 25.58, 72.98 + 34.84), 0.7),
                 knee = 0.4 * largest;
    const double black = 0.95 + (std::pow(100.0, 0.7) - knee) / (largest - knee) * 0.05;
    EXPECT_NEAR(between(glm::vec3(0), glm::vec3(1)), black, 1e-4);
    EXPECT_NEAR(black, 0.9674, 1e-4);
    // These greys differ by less than the knee; their lightness is 116 cbrt(Y) - 16.
    const double step = 116.0 * (std::cbrt(0.5) - std::cbrt(0.4));
    EXPECT_NEAR(between(glm::vec3(0.5f), glm::vec3(0.4f)), std::pow(step, 0.7) / knee * 0.95, 1e-4);
}

// Means and single texels come from a separate program in numpy, after the authors' published one: it has
// full 2D kernels instead of separated ones, in doubles.
TEST(Flip, AgreesWithADirectEvaluation) {
    const auto noisy = flip(input(40, 30, noise(40, 30, 1), noise(40, 30, 2)));
    EXPECT_NEAR(mean(noisy), 0.392662, 2e-5);
    EXPECT_NEAR(noisy[0], 0.772453, 1e-4);
    EXPECT_NEAR(noisy[15 * 40 + 20], 0.566229, 1e-4);
    const auto nearer = flip(input(40, 30, noise(40, 30, 1), noise(40, 30, 2)), 20.0);
    EXPECT_NEAR(mean(nearer), 0.813813, 2e-5);
    EXPECT_NEAR(mean(flip(input(17, 9, noise(17, 9, 1), noise(17, 9, 2)))), 0.421210, 2e-5);

    const auto square = [](uint32_t x, uint32_t y) {
        return x >= 10 && x < 30 && y >= 8 && y < 20 ? glm::vec3(0.6f, 0.3f, 0.2f) : glm::vec3(0.5f);
    };
    const auto seen = flip(input(48, 32, flat(48, 32, glm::vec3(0.5f)), picture(48, 32, square)));
    EXPECT_NEAR(mean(seen), 0.142904, 2e-5);
    EXPECT_NEAR(seen[14 * 48 + 20], 0.645823, 1e-4);
    EXPECT_NEAR(seen[8 * 48 + 10], 0.430946, 1e-4);
    EXPECT_NEAR(seen[14 * 48 + 31], 0.263300, 1e-4);
}

TEST(Flip, DoesNotCareWhichPictureIsTheReference) {
    const auto there = flip(input(40, 30, noise(40, 30, 1), noise(40, 30, 2)));
    const auto back = flip(input(40, 30, noise(40, 30, 2), noise(40, 30, 1)));
    for (size_t i = 0; i < there.size(); ++i)
        EXPECT_NEAR(there[i], back[i], 1e-6);
}

TEST(Flip, SeesLessFromFartherAway) {
    const auto a = noise(64, 64, 1), b = noise(64, 64, 2);
    const double near = mean(flip(input(64, 64, a, b), 20)), middle = mean(flip(input(64, 64, a, b), 67));
    const double far = mean(flip(input(64, 64, a, b), 200));
    EXPECT_GT(near, 1.5 * middle);
    EXPECT_GT(middle, 1.5 * far);
}

// Without care the empty texels would bleed into the charts and their edges would hide differences.
TEST(Flip, LeavesUncoveredTexelsOut) {
    FlipInput pair = input(40, 30, flat(40, 30, glm::vec3(0.5f)), flat(40, 30, glm::vec3(0.4f)));
    const float whole = flip(pair).at(0);
    for (size_t i = 0; i < pair.covered.size(); ++i) {
        pair.covered[i] = i % 40 < 13 || (i / 40 > 20 && i % 3 != 0);
        if (!pair.covered[i]) {
            pair.a[i] = glm::vec3(0.0f);
            pair.b[i] = glm::vec3(1.0f);
        }
    }
    const auto masked = flip(pair);
    for (size_t i = 0; i < masked.size(); ++i)
        EXPECT_NEAR(masked[i], pair.covered[i] ? whole : 0.0f, 1e-4) << i;
}

TEST(Flip, HandlesASingleTexel) {
    EXPECT_NEAR(flip(input(1, 1, flat(1, 1, glm::vec3(0)), flat(1, 1, glm::vec3(1)))).at(0), 0.9674, 1e-4);
}

} // namespace
} // namespace relume
