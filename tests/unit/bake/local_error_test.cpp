#include "bake/base/local_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace relume {
namespace {

using shader::binOf;

std::vector<uint32_t> errorBins(const std::vector<float>& errors) {
    std::vector<uint32_t> bins(shader::kErrorBins, 0);
    for (const float error : errors)
        ++bins[binOf(error, shader::kLeastErrorOctave, shader::kErrorBinsPerOctave, shader::kErrorBins)];
    return bins;
}

TEST(LocalErrorBins, PercentilesAreThoseOfTheSortedValues) {
    std::mt19937 random(3);
    std::lognormal_distribution<float> spread(-3.0f, 1.5f);
    std::vector<float> errors(20000);
    std::generate(errors.begin(), errors.end(), [&] { return spread(random); });
    const LocalError told = localErrorOf(errorBins(errors));
    std::sort(errors.begin(), errors.end());
    const auto at = [&](double share) {
        return errors[static_cast<size_t>(share * static_cast<double>(errors.size()))];
    };
    EXPECT_NEAR(told.p50, at(0.50), 0.01 * at(0.50));
    EXPECT_NEAR(told.p90, at(0.90), 0.01 * at(0.90));
    EXPECT_NEAR(told.p95, at(0.95), 0.01 * at(0.95));
    EXPECT_NEAR(told.p99, at(0.99), 0.02 * at(0.99));
}

// Noise and a bias of either sign in proportion to it, as they are taken to be.
TEST(LocalErrorBins, BiasAddsToNoiseAsSquaresDo) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::bernoulli_distribution sign;
    std::vector<float> noise, both;
    double noiseSquares = 0, biasSquares = 0;
    for (uint32_t i = 0; i < 20000; ++i) {
        const double own = std::exp2(4.0 * i / 20000.0) * 0.01; // a texel's standard error
        const double error = own * normal(random), bias = (sign(random) ? 0.7 : -0.7) * own;
        noise.push_back(static_cast<float>(std::abs(error)));
        both.push_back(static_cast<float>(std::abs(error + bias)));
        noiseSquares += error * error;
        biasSquares += bias * bias;
    }
    const LocalError alone = localErrorOf(errorBins(noise)), truly = localErrorOf(errorBins(both));
    const LocalError told = withBias(alone, noiseSquares, biasSquares);
    EXPECT_LT(alone.p95, 0.87 * truly.p95);
    EXPECT_NEAR(told.p50, truly.p50, 0.1 * truly.p50);
    EXPECT_NEAR(told.p95, truly.p95, 0.06 * truly.p95);
    EXPECT_NEAR(told.p99, truly.p99, 0.1 * truly.p99);
    EXPECT_EQ(withBias(alone, noiseSquares, -1.0).p95, alone.p95);
    EXPECT_EQ(withBias({0, 0, 0, 0}, 0.0, 1.0).p95, 0.0);
}

TEST(LocalErrorBins, WhatIsExactIsOffByNothing) {
    std::vector<float> errors(1000, 0.0f);
    std::fill_n(errors.begin(), 60, 0.25f);
    const LocalError told = localErrorOf(errorBins(errors));
    EXPECT_EQ(told.p90, 0.0);
    EXPECT_NEAR(told.p95, 0.25, 0.25 * 0.05);
}

TEST(LocalErrorBins, ValuesBeyondTheBinsAreKeptAtTheirEnds) {
    EXPECT_EQ(binOf(0.0f, -24.0f, 16.0f, 448), 0u);
    EXPECT_EQ(binOf(1e-30f, -24.0f, 16.0f, 448), 0u);
    EXPECT_EQ(binOf(1e30f, -24.0f, 16.0f, 448), 447u);
    EXPECT_EQ(binOf(std::nanf(""), -24.0f, 16.0f, 448), 0u);
}

TEST(LocalErrorBins, MedianLight) {
    std::vector<uint32_t> bins(shader::kLightBins, 0);
    for (int i = 0; i < 1001; ++i) {
        const float light = 0.01f * static_cast<float>(i + 1); // the middle one is 5.01
        ++bins[binOf(light, shader::kLeastLightOctave, shader::kLightBinsPerOctave, shader::kLightBins)];
    }
    EXPECT_NEAR(medianLight(bins), 5.01, 0.02 * 5.01);
    EXPECT_EQ(medianLight(std::vector<uint32_t>(shader::kLightBins, 0)), 0.0);
}

} // namespace
} // namespace relume
