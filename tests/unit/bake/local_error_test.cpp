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
