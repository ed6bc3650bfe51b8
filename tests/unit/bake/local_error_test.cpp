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

// Normally distributed errors are beyond the aim with a chance of erfc(aim / (off sqrt(2))); its derivative
// by the variance, off^2, is the worth up to one factor.
TEST(LocalWorth, IsHowFastTexelsComeWithinTheAim) {
    constexpr double kAim = 0.05, kStep = 1e-4;
    const auto slope = [](double off) {
        const auto beyond = [](double variance) { return std::erfc(kAim / std::sqrt(2.0 * variance)); };
        return (beyond((1 + kStep) * off * off) - beyond((1 - kStep) * off * off)) / (2 * kStep * off * off);
    };
    const auto worth = [](double off) {
        return double{shader::localWorth(static_cast<float>(off), static_cast<float>(kAim))};
    };
    for (const double off : {0.01, 0.02, 0.03, 0.05, 0.1, 0.5})
        EXPECT_NEAR(worth(off) / worth(kAim), slope(off) / slope(kAim), 1e-3 * slope(off) / slope(kAim))
            << off;
    for (const double off : {0.0, 1e-30, 0.004})
        EXPECT_EQ(worth(off), 0.0) << off;
    EXPECT_GE(worth(1e30), 0.0);
}

// Texels of chunks of 64 with noise of unlike strength and, in some of them, a bias; the bias
// of a chunk is estimated with noise of its own. Returns what is told of noise alone and of both, and what is
// true.
struct ToldAndTrue {
    LocalError noise, told, truly;
};
ToldAndTrue biasedChunks(double bias, double shareOfChunks, double shareOfTexels = 1.0) {
    std::mt19937 random(5), randomFourth(6);
    std::normal_distribution<double> normal, normalFourth;
    std::bernoulli_distribution isBiased(shareOfChunks), isBiasedThere(shareOfTexels);
    std::vector<float> noise, both;
    std::vector<ChunkSquares> chunks;
    for (uint32_t c = 0; c < 2000; ++c) {
        const double own = std::exp2(4.0 * c / 2000.0) * 0.01; // its texels' standard error
        const double of = isBiased(random) ? bias * own : 0.0;
        ChunkSquares chunk{.texels = shader::kChunk};
        for (uint32_t i = 0; i < shader::kChunk; ++i) {
            const double error = own * normal(random);
            const double off = isBiasedThere(randomFourth) ? of * normal(random) : 0.0;
            noise.push_back(static_cast<float>(std::abs(error)));
            both.push_back(static_cast<float>(std::abs(error + off)));
            chunk.noise += own * own;
            chunk.bias += off * off + own * own * normal(random); // as uncertain as 64 texels leave it
            // Four replicates, each of twice the mean's error, are multiplied.
            double product = 1;
            for (int replicate = 0; replicate < 4; ++replicate)
                product *= off + 2.0 * own * normalFourth(randomFourth);
            chunk.fourth += product;
        }
        chunks.push_back(chunk);
    }
    WorkerPool pool(2);
    const LocalError alone = localErrorOf(errorBins(noise));
    return {alone, withBias(pool, alone, chunks), localErrorOf(errorBins(both))};
}

void expectNear(const LocalError& told, const LocalError& truly, double share) {
    EXPECT_NEAR(told.p50, truly.p50, share * truly.p50);
    EXPECT_NEAR(told.p95, truly.p95, share * truly.p95);
    EXPECT_NEAR(told.p99, truly.p99, share * truly.p99);
}

TEST(LocalErrorBins, BiasAddsToNoiseWhereItIs) {
    const ToldAndTrue none = biasedChunks(0.0, 0.0);
    expectNear(none.told, none.noise, 0.05);
    const ToldAndTrue everywhere = biasedChunks(0.7, 1.0);
    EXPECT_LT(everywhere.noise.p95, 0.87 * everywhere.truly.p95);
    expectNear(everywhere.told, everywhere.truly, 0.12);
    // Much bias in few places is nothing to the median, and little to what most texels stay below.
    const ToldAndTrue few = biasedChunks(12.0, 0.03);
    EXPECT_GT(few.truly.p99, 2.0 * few.noise.p99);
    EXPECT_NEAR(few.told.p50, few.truly.p50, 0.1 * few.truly.p50);
    EXPECT_NEAR(few.told.p95, few.truly.p95, 0.25 * few.truly.p95);
}

TEST(LocalErrorBins, BiasInFewTexelsOfAChunkIsNotSpreadOverAll) {
    const ToldAndTrue edges = biasedChunks(12.0, 0.3, 0.1);
    EXPECT_GT(edges.truly.p99, 1.5 * edges.noise.p99);
    EXPECT_NEAR(edges.told.p50, edges.truly.p50, 0.1 * edges.truly.p50);
    EXPECT_NEAR(edges.told.p95, edges.truly.p95, 0.15 * edges.truly.p95);
}

TEST(LocalErrorBins, WithoutChunksNoiseIsAllThatIsTold) {
    WorkerPool pool(1);
    const LocalError told = withBias(pool, {0.1, 0.2, 0.3, 0.4}, {});
    EXPECT_EQ(told.p50, 0.1);
    EXPECT_EQ(told.p99, 0.4);
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
