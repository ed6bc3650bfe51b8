#include "bake/gather/sample_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace relume {
namespace {

double varianceAfter(const SampledPart& part, uint32_t samplePasses) {
    return part.variance * part.samplePasses / samplePasses;
}

double costOf(const SampledPart& first, const SampledPart& second, SamplePasses samplePasses) {
    return samplePasses.first * first.costOfSamplePass + samplePasses.second * second.costOfSamplePass;
}

TEST(LevelGrowth, EqualPartsGrowAlike) {
    const SampledPart part{.samplePasses = 2, .most = 1000, .variance = 3.0, .costOfSamplePass = 1.0};
    EXPECT_EQ(samplePassesFor(part, part, 6.0 / 4.0), (SamplePasses{8, 8}));
    EXPECT_EQ(samplePassesFor(part, part, 6.0 / 3.5), (SamplePasses{8, 8})); // the ladder's next step
    EXPECT_EQ(samplePassesFor(part, part, 6.0 / 3.0), (SamplePasses{6, 6}));
}

TEST(LevelGrowth, WhatHasEnoughStays) {
    const SampledPart exact{.samplePasses = 4, .most = 1000, .variance = 0.0, .costOfSamplePass = 1.0};
    const SampledPart noisy{.samplePasses = 2, .most = 1000, .variance = 8.0, .costOfSamplePass = 16.0};
    EXPECT_EQ(samplePassesFor(exact, noisy, 4.0), (SamplePasses{4, 4}));
    EXPECT_EQ(samplePassesFor(noisy, exact, 4.0), (SamplePasses{4, 4}));
}

TEST(LevelGrowth, WhatOnePartCannotHaveTheOtherMakesUpFor) {
    const SampledPart at{.samplePasses = 4, .most = 4, .variance = 1.0, .costOfSamplePass = 1.0};
    const SampledPart other{.samplePasses = 2, .most = 1000, .variance = 1.0, .costOfSamplePass = 1.0};
    EXPECT_EQ(samplePassesFor(at, other, 1.25), (SamplePasses{4, 8}));
    EXPECT_EQ(samplePassesFor(other, at, 1.25), (SamplePasses{8, 4}));
}

TEST(LevelGrowth, EndsWhereThereAreNoMore) {
    const SampledPart few{.samplePasses = 2, .most = 5, .variance = 1.0, .costOfSamplePass = 1.0};
    EXPECT_EQ(samplePassesFor(few, few, 1e-6), (SamplePasses{5, 5}));
    const SampledPart all{.samplePasses = 5, .most = 5, .variance = 1.0, .costOfSamplePass = 1.0};
    EXPECT_EQ(samplePassesFor(all, all, 1e-6), (SamplePasses{5, 5}));
}

// This holds where something else than samples misses the aim, too.
TEST(LevelGrowth, AlwaysTakesMore) {
    const SampledPart cheap{.samplePasses = 4, .most = 1000, .variance = 1.0, .costOfSamplePass = 1.0};
    const SampledPart dear{.samplePasses = 4, .most = 1000, .variance = 1.0, .costOfSamplePass = 9.0};
    for (const double allowed : {-1.0, 0.0, 2.0, 5.0}) {
        EXPECT_EQ(samplePassesFor(cheap, dear, allowed), (SamplePasses{8, 4})) << allowed;
        EXPECT_EQ(samplePassesFor(dear, cheap, allowed), (SamplePasses{4, 8})) << allowed;
    }
    const SampledPart none{.samplePasses = 0, .most = 0, .variance = 0.0, .costOfSamplePass = 16.0};
    EXPECT_EQ(samplePassesFor(cheap, none, 2.0), (SamplePasses{8, 0}));
}

// Thirty parts want 11 sample passes each; were all to take the 16 of the next step, a third less variance
// would be left than is allowed.
TEST(LevelGrowth, ManyPartsMeetWhatIsAllowed) {
    std::vector<SampledPart> parts(
        30, {.samplePasses = 4, .most = 100, .variance = 1, .costOfSamplePass = 1, .doubles = true});
    parts[3].variance = 1.1;
    const double allowed = 30.0 * 4.0 / 11.0;
    const std::vector<uint32_t> samplePasses = samplePassesFor(parts, allowed);
    double left = 0, cost = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
        EXPECT_TRUE(samplePasses[i] == 8 || samplePasses[i] == 16);
        left += 4.0 * parts[i].variance / samplePasses[i];
        cost += samplePasses[i];
    }
    EXPECT_LE(left, allowed);
    EXPECT_GT(left, 0.97 * allowed);
    EXPECT_LT(cost, 30 * 13);
    EXPECT_EQ(samplePasses[3], 16u) << "which brings most";
}

TEST(LevelGrowth, NoPartOfManyGoesBackOrBeyondItsLimits) {
    const std::vector<SampledPart> parts = {{.samplePasses = 5, .most = 100, .variance = 0.01},
                                            {.samplePasses = 5, .most = 7, .variance = 10},
                                            {.samplePasses = 2, .most = 100, .variance = 10}};
    EXPECT_EQ(samplePassesFor(parts, 1e-6), (std::vector<uint32_t>{24, 7, 8}));
    EXPECT_EQ(samplePassesFor(parts, 30.0), (std::vector<uint32_t>{5, 5, 2}));
}

// The growth is held against all pairs within its limits: a step of the ladder is half as much again at most.
TEST(LevelGrowth, CostsLittleMoreThanTheLeast) {
    std::mt19937 random(1);
    constexpr uint32_t kLadder[] = {1, 2, 3, 4, 6, 8};
    std::uniform_real_distribution<double> decades(-1.5, 1.5), share(0.05, 0.95);
    for (int i = 0; i < 200; ++i) {
        const auto part = [&] {
            return SampledPart{.samplePasses = kLadder[random() % std::size(kLadder)],
                               .most = 1000,
                               .variance = std::pow(10.0, decades(random)),
                               .costOfSamplePass = std::pow(10.0, decades(random))};
        };
        const SampledPart first = part(), second = part();
        const double allowed = share(random) * (first.variance + second.variance);
        const SamplePasses samplePasses = samplePassesFor(first, second, allowed);
        EXPECT_LE(samplePasses.first, 8 * first.samplePasses);
        EXPECT_LE(samplePasses.second, 8 * second.samplePasses);
        double least = 1e30;
        for (uint32_t a = first.samplePasses; a <= 8 * first.samplePasses; ++a)
            for (uint32_t b = second.samplePasses; b <= 8 * second.samplePasses; ++b)
                if (varianceAfter(first, a) + varianceAfter(second, b) <= allowed)
                    least = std::min(least, costOf(first, second, {a, b}));
        const bool limited =
            samplePasses.first == 8 * first.samplePasses || samplePasses.second == 8 * second.samplePasses;
        if (limited) continue;
        EXPECT_LE(varianceAfter(first, samplePasses.first) + varianceAfter(second, samplePasses.second),
                  allowed * (1.0 + 1e-9));
        EXPECT_LE(costOf(first, second, samplePasses), 1.5 * least) << i;
    }
}

// A part whose variance falls faster needs fewer for as much; no plan that leaves as much costs less.
TEST(LevelGrowth, HowVariancesFallCounts) {
    std::vector<SampledPart> parts(2,
                                   {.samplePasses = 32, .most = 4096, .variance = 1, .costOfSamplePass = 1});
    parts[1].fall = 1.5;
    const double allowed = 0.5;
    const std::vector<uint32_t> planned = samplePassesFor(parts, allowed);
    const auto left = [&](double first, double second) {
        return 32.0 / first + std::pow(32.0 / second, 1.5);
    };
    EXPECT_LT(planned[1], planned[0]);
    EXPECT_LE(left(planned[0], planned[1]), allowed);
    double least = 1e9;
    for (double first = 32; first < 4096; first += 1)
        for (double second = 32; second < 512; second += 1)
            if (left(first, second) <= allowed) least = std::min(least, first + second);
    EXPECT_LT(planned[0] + planned[1], 1.34 * least) << "a step of the ladder is a third at most";
}

TEST(LevelGrowth, ThePowerThatAVarianceFallsWithIsToldByTwoLevels) {
    EXPECT_NEAR(fallOfVariance(8, 4.0, 32, 4.0 / std::pow(4.0, 1.25), 1.0), 1.25, 1e-12);
    EXPECT_EQ(fallOfVariance(8, 4.0, 32, 3.9, 1.0), 1.0) << "no slower than of independent samples";
    EXPECT_EQ(fallOfVariance(8, 4.0, 32, 1e-9, 1.0), 1.5) << "nor faster than is known of edges";
    EXPECT_EQ(fallOfVariance(32, 4.0, 32, 3.0, 1.2), 1.2) << "of as many nothing is told";
    EXPECT_EQ(fallOfVariance(0, 0.0, 32, 3.0, 1.2), 1.2);
    EXPECT_EQ(fallOfVariance(8, 4.0, 32, 0.0, 1.2), 1.2);
}

} // namespace
} // namespace relume
