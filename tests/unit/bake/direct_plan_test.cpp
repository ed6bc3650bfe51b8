// Sample passes of direct light by chunk.
#include "bake/links/direct_plan.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

constexpr double kPatchesOfChunk = 64;
constexpr size_t kPlannedChunks = 40, kNoisy = 10; // the noisy ones are the last

// Makes a plan that has learned of chunks whose direct light has these variances after `done` sample passes.
DirectPlan learned(const std::vector<double>& variances, uint32_t done) {
    std::vector<ChunkVariance> chunks;
    for (const double v : variances)
        chunks.push_back({.patches = kPatchesOfChunk, .direct = kPatchesOfChunk * v});
    static WorkerPool one(1);
    DirectPlan plan(one, static_cast<uint32_t>(variances.size()));
    plan.learn(chunks, std::vector<uint32_t>(variances.size(), done), false);
    return plan;
}

std::vector<double> someNoisy(double quiet, double noisy) {
    std::vector<double> variances(kPlannedChunks, quiet);
    std::fill(variances.end() - kNoisy, variances.end(), noisy);
    return variances;
}

std::vector<uint32_t> allHave(uint32_t samplePasses) {
    return std::vector<uint32_t>(kPlannedChunks, samplePasses);
}

constexpr DirectPlanRules kDirectRules{.cost = 10, .linkGain = 0.001, .most = 4096};

DirectPlanRules directRules(void (*change)(DirectPlanRules&)) {
    DirectPlanRules rules = kDirectRules;
    change(rules);
    return rules;
}

} // namespace

// One more sample pass of n takes v / n of a variance v: 1 / 4 is worth 10 times 0.001, and 0.001 / 4 is not.
TEST(DirectPlan, OnlyChunksThatAreOffGetMore) {
    const DirectPlan plan = learned(someNoisy(0.001, 1.0), 4);
    const std::vector<uint32_t> wanted = plan.wanted(kDirectRules, allHave(4));
    EXPECT_EQ(wanted.front(), 4u);
    EXPECT_EQ(wanted.back(), 4 * kMostChunkGrowth) << "up to sqrt(4 / 0.01) = 20, but for the growth";
    EXPECT_EQ(learned(someNoisy(0.001, 0.16), 4).wanted(kDirectRules, allHave(4)).back(), 8u)
        << "sqrt(0.64 / 0.01)";
}

TEST(DirectPlan, EveryChunkHasTheLeast) {
    const DirectPlan plan = learned(someNoisy(0.0, 0.0), 1);
    EXPECT_EQ(plan.wanted(kDirectRules, allHave(1)), allHave(1));
    EXPECT_EQ(plan.wanted(directRules([](DirectPlanRules& r) { r.least = 3; }), allHave(1)), allHave(3));
}

TEST(DirectPlan, NoMoreIsPlannedThanIsAskedFor) {
    const DirectPlan plan = learned(someNoisy(0.01, 1.0), 4);
    DirectPlanRules rules = directRules([](DirectPlanRules& r) { r.linkGain = 1e-6; });
    const double before = plan.left(allHave(4));
    rules.allowed = 0.5 * before;
    const std::vector<uint32_t> wanted = plan.wanted(rules, allHave(4));
    EXPECT_LE(plan.left(wanted), rules.allowed);
    EXPECT_GT(plan.left(wanted), 0.5 * rules.allowed) << "steps of the ladder are half of what there is";
    EXPECT_EQ(wanted.front(), 4u) << "the noisy ones do it";
    rules.allowed = 2.0 * before;
    EXPECT_EQ(plan.wanted(rules, allHave(4)), allHave(4)) << "it is there already";
}

TEST(DirectPlan, FewChunksGetNoneThatDoesNotMakeUpForItsCost) {
    std::vector<double> variances(kPlannedChunks, 0.0);
    variances[20] = 0.06; // worth 0.24 / 16 = 0.015 for its own cost of 0.01, and not for twice that
    const DirectPlan plan = learned(variances, 4);
    const auto alone = plan.wanted(kDirectRules, allHave(4));
    EXPECT_GT(alone[20], 4u);
    DirectPlanRules rules = kDirectRules;
    rules.passCost = 2.0 * rules.cost * kPatchesOfChunk;
    EXPECT_EQ(plan.wanted(rules, allHave(4)), allHave(4));
    rules.least = 5;
    EXPECT_EQ(plan.wanted(rules, allHave(4)), allHave(5)) << "all have these whatever they are worth";
}

// Against what links bring few chunks pay for a sample pass, and so they get what the error needs, whatever
// that costs beside what chunks cost by themselves.
TEST(DirectPlan, WhatIsAskedForIsReachedHoweverDearASamplePassIs) {
    const DirectPlan plan = learned(someNoisy(0.0, 1.0), 4);
    DirectPlanRules rules = directRules([](DirectPlanRules& r) { r.linkGain = 1e-6; });
    rules.passCost = 1e3 * rules.cost * kPatchesOfChunk;
    rules.allowed = 0.5 * plan.left(allHave(4));
    EXPECT_LE(plan.left(plan.wanted(rules, allHave(4))), rules.allowed);
}

TEST(DirectPlan, SettledIsWhatGetsNoMore) {
    const DirectPlan plan = learned(someNoisy(0.001, 1.0), 4);
    const std::vector<uint32_t> wanted = plan.wanted(kDirectRules, allHave(4));
    const auto noisy =
        static_cast<double>(std::count_if(wanted.begin(), wanted.end(), [](uint32_t n) { return n > 4; }));
    EXPECT_GE(noisy, kNoisy) << "and neighbours of the first one";
    EXPECT_NEAR(plan.settled(wanted, allHave(4)), (kPlannedChunks - noisy) * kPatchesOfChunk * 0.001, 1e-9);
    EXPECT_EQ(plan.settled(allHave(4), allHave(4)), plan.left(allHave(4)));
}

} // namespace relume
