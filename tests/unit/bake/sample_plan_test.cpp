#include "bake/gather/sample_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace relume {
namespace {

double varianceAfter(const SampledPart& part, uint32_t rounds) {
    return part.variance * part.rounds / rounds;
}

double costOf(const SampledPart& first, const SampledPart& second, Rounds rounds) {
    return rounds.first * first.costOfRound + rounds.second * second.costOfRound;
}

TEST(LevelGrowth, EqualPartsGrowAlike) {
    const SampledPart part{.rounds = 2, .most = 1000, .variance = 3.0, .costOfRound = 1.0};
    EXPECT_EQ(roundsFor(part, part, 6.0 / 4.0), (Rounds{8, 8}));
    EXPECT_EQ(roundsFor(part, part, 6.0 / 3.5), (Rounds{8, 8})); // the ladder's next step
    EXPECT_EQ(roundsFor(part, part, 6.0 / 3.0), (Rounds{6, 6}));
}

TEST(LevelGrowth, WhatHasEnoughStays) {
    const SampledPart exact{.rounds = 4, .most = 1000, .variance = 0.0, .costOfRound = 1.0};
    const SampledPart noisy{.rounds = 2, .most = 1000, .variance = 8.0, .costOfRound = 16.0};
    EXPECT_EQ(roundsFor(exact, noisy, 4.0), (Rounds{4, 4}));
    EXPECT_EQ(roundsFor(noisy, exact, 4.0), (Rounds{4, 4}));
}

TEST(LevelGrowth, WhatOnePartCannotHaveTheOtherMakesUpFor) {
    const SampledPart at{.rounds = 4, .most = 4, .variance = 1.0, .costOfRound = 1.0};
    const SampledPart other{.rounds = 2, .most = 1000, .variance = 1.0, .costOfRound = 1.0};
    EXPECT_EQ(roundsFor(at, other, 1.25), (Rounds{4, 8}));
    EXPECT_EQ(roundsFor(other, at, 1.25), (Rounds{8, 4}));
}

TEST(LevelGrowth, EndsWhereThereAreNoMore) {
    const SampledPart few{.rounds = 2, .most = 5, .variance = 1.0, .costOfRound = 1.0};
    EXPECT_EQ(roundsFor(few, few, 1e-6), (Rounds{5, 5}));
    const SampledPart all{.rounds = 5, .most = 5, .variance = 1.0, .costOfRound = 1.0};
    EXPECT_EQ(roundsFor(all, all, 1e-6), (Rounds{5, 5}));
}

// This holds where something else than samples misses the aim, too.
TEST(LevelGrowth, AlwaysTakesMore) {
    const SampledPart cheap{.rounds = 4, .most = 1000, .variance = 1.0, .costOfRound = 1.0};
    const SampledPart dear{.rounds = 4, .most = 1000, .variance = 1.0, .costOfRound = 9.0};
    for (const double allowed : {-1.0, 0.0, 2.0, 5.0}) {
        EXPECT_EQ(roundsFor(cheap, dear, allowed), (Rounds{8, 4})) << allowed;
        EXPECT_EQ(roundsFor(dear, cheap, allowed), (Rounds{4, 8})) << allowed;
    }
    const SampledPart none{.rounds = 0, .most = 0, .variance = 0.0, .costOfRound = 16.0};
    EXPECT_EQ(roundsFor(cheap, none, 2.0), (Rounds{8, 0}));
}

// Thirty parts want 11 sample passes each; were all to take the 16 of the next step, a third less variance
// would be left than is allowed.
TEST(LevelGrowth, ManyPartsMeetWhatIsAllowed) {
    std::vector<SampledPart> parts(
        30, {.rounds = 4, .most = 100, .variance = 1, .costOfRound = 1, .doubles = true});
    parts[3].variance = 1.1;
    const double allowed = 30.0 * 4.0 / 11.0;
    const std::vector<uint32_t> rounds = roundsFor(parts, allowed);
    double left = 0, cost = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
        EXPECT_TRUE(rounds[i] == 8 || rounds[i] == 16);
        left += 4.0 * parts[i].variance / rounds[i];
        cost += rounds[i];
    }
    EXPECT_LE(left, allowed);
    EXPECT_GT(left, 0.97 * allowed);
    EXPECT_LT(cost, 30 * 13);
    EXPECT_EQ(rounds[3], 16u) << "which brings most";
}

TEST(LevelGrowth, NoPartOfManyGoesBackOrBeyondItsLimits) {
    const std::vector<SampledPart> parts = {{.rounds = 5, .most = 100, .variance = 0.01},
                                            {.rounds = 5, .most = 7, .variance = 10},
                                            {.rounds = 2, .most = 100, .variance = 10}};
    EXPECT_EQ(roundsFor(parts, 1e-6), (std::vector<uint32_t>{24, 7, 8}));
    EXPECT_EQ(roundsFor(parts, 30.0), (std::vector<uint32_t>{5, 5, 2}));
}

// The growth is held against all pairs within its limits: a step of the ladder is half as much again at most.
TEST(LevelGrowth, CostsLittleMoreThanTheLeast) {
    std::mt19937 random(1);
    constexpr uint32_t kLadder[] = {1, 2, 3, 4, 6, 8};
    std::uniform_real_distribution<double> decades(-1.5, 1.5), share(0.05, 0.95);
    for (int i = 0; i < 200; ++i) {
        const auto part = [&] {
            return SampledPart{.rounds = kLadder[random() % std::size(kLadder)],
                               .most = 1000,
                               .variance = std::pow(10.0, decades(random)),
                               .costOfRound = std::pow(10.0, decades(random))};
        };
        const SampledPart first = part(), second = part();
        const double allowed = share(random) * (first.variance + second.variance);
        const Rounds rounds = roundsFor(first, second, allowed);
        EXPECT_LE(rounds.first, 8 * first.rounds);
        EXPECT_LE(rounds.second, 8 * second.rounds);
        double least = 1e30;
        for (uint32_t a = first.rounds; a <= 8 * first.rounds; ++a)
            for (uint32_t b = second.rounds; b <= 8 * second.rounds; ++b)
                if (varianceAfter(first, a) + varianceAfter(second, b) <= allowed)
                    least = std::min(least, costOf(first, second, {a, b}));
        const bool limited = rounds.first == 8 * first.rounds || rounds.second == 8 * second.rounds;
        if (limited) continue;
        EXPECT_LE(varianceAfter(first, rounds.first) + varianceAfter(second, rounds.second),
                  allowed * (1.0 + 1e-9));
        EXPECT_LE(costOf(first, second, rounds), 1.5 * least) << i;
    }
}

} // namespace
} // namespace relume
