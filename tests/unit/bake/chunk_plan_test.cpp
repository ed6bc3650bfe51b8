#include "bake/gather/chunk_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace relume {
namespace {

constexpr double kChunkPatches = 64;

ChunkPlan after(size_t chunks, uint32_t direct, uint32_t links) {
    return {std::vector<uint32_t>(chunks, direct), std::vector<uint32_t>(chunks, links)};
}

// Makes a chunk whose patches are off by so much each, relative to what local error is relative to.
ChunkVariance off(double direct, double links) {
    return {.patches = kChunkPatches,
            .direct = kChunkPatches * direct * direct,
            .indirect = kChunkPatches * links * links,
            .localDirect = kChunkPatches * direct * direct,
            .localIndirect = kChunkPatches * links * links};
}

ChunkPlanRules local(double error) {
    return {
        .localError = error, .directCost = 4, .linkCost = 16, .mostSamplePasses = 4096, .hasDirect = true};
}

// Sets chunks of one kind far enough from each other that none is another's neighbour.
std::vector<ChunkVariance> apart(const ChunkVariance& one, const ChunkVariance& other) {
    std::vector<ChunkVariance> chunks(20, one);
    std::fill(chunks.begin() + 10, chunks.end(), other);
    return chunks;
}

TEST(ChunkPlan, WhatIsReachedGetsNoMore) {
    const std::vector<ChunkVariance> chunks = apart(off(0.001, 0.01), off(0.0, 0.0));
    const ChunkPlan now = after(chunks.size(), 4, 4);
    EXPECT_EQ(planChunks(local(0.02), chunks, now), now);
}

TEST(ChunkPlan, OnlyChunksThatAreOffGetMore) {
    const std::vector<ChunkVariance> chunks = apart(off(0.0, 0.001), off(0.0, 0.03));
    const ChunkPlan now = after(chunks.size(), 4, 4);
    const ChunkPlan plan = planChunks(local(0.02), chunks, now);
    EXPECT_EQ(plan.links.front(), 4u);
    EXPECT_GE(plan.links.back(), 4 * 9 / 4u) << "variance falls as one over the sample passes";
    EXPECT_LE(plan.links.back(), 16u);
    EXPECT_EQ(plan.direct, now.direct) << "which is not off";
}

TEST(ChunkPlan, NoChunkGrowsByMoreThanIsTrusted) {
    const std::vector<ChunkVariance> chunks = apart(off(0.0, 10.0), off(5.0, 0.0));
    const ChunkPlan plan = planChunks(local(0.01), chunks, after(chunks.size(), 3, 2));
    EXPECT_EQ(plan.links.front(), 2 * kMostChunkGrowth);
    EXPECT_EQ(plan.direct.back(), 3 * kMostChunkGrowth);
}

TEST(ChunkPlan, NeighboursOfNoiseAreNotTrusted) {
    std::vector<ChunkVariance> chunks(9, off(0.0, 0.0));
    chunks[4] = off(0.0, 0.2);
    const ChunkPlan plan = planChunks(local(0.02), chunks, after(chunks.size(), 1, 4));
    EXPECT_GT(plan.links[2], 4u);
    EXPECT_GT(plan.links[6], 4u);
    EXPECT_EQ(plan.links[1], 4u);
    EXPECT_EQ(plan.links[7], 4u);
}

TEST(ChunkPlan, CheapSamplesTakeMoreOfTheNoise) {
    const std::vector<ChunkVariance> chunks(5, off(0.03, 0.03));
    ChunkPlanRules rules = local(0.03);
    const ChunkPlan plan = planChunks(rules, chunks, after(chunks.size(), 4, 4));
    EXPECT_GT(plan.direct[2], plan.links[2]);
    std::swap(rules.directCost, rules.linkCost);
    const ChunkPlan other = planChunks(rules, chunks, after(chunks.size(), 4, 4));
    EXPECT_LT(other.direct[2], other.links[2]);
}

TEST(ChunkPlan, NothingIsAskedOfLightsWhereThereAreNone) {
    ChunkPlanRules rules = local(0.02);
    rules.hasDirect = false;
    const std::vector<ChunkVariance> chunks(5, off(0.0, 0.1));
    const ChunkPlan plan = planChunks(rules, chunks, after(chunks.size(), 0, 4));
    EXPECT_EQ(plan.direct, std::vector<uint32_t>(5, 0));
    EXPECT_GT(plan.links[2], 4u);
}

TEST(ChunkPlan, EmptyChunksGetNothing) {
    std::vector<ChunkVariance> chunks(12, ChunkVariance{});
    chunks[0] = off(0.0, 1.0);
    ChunkPlanRules rules = local(0.02);
    rules.variance = 1e-6;
    const ChunkPlan plan = planChunks(rules, chunks, after(chunks.size(), 1, 1));
    for (size_t i = 1; i < chunks.size(); ++i)
        EXPECT_EQ(plan.links[i], 1u) << i;
}

// The least sum of variance / sample passes for a cost has sample passes in proportion to the root of
// variance over cost: no plan of one more here and one less there may be better than the one that is made,
// but for the ladder.
TEST(ChunkPlan, TheWholeIsReachedForTheLeastCost) {
    std::vector<ChunkVariance> chunks = apart(off(0.0, 0.1), off(0.0, 0.4));
    const ChunkPlan now = after(chunks.size(), 1, 16);
    const double before =
        std::accumulate(chunks.begin(), chunks.end(), 0.0,
                        [](double sum, const ChunkVariance& c) { return sum + c.indirect; });
    const ChunkPlanRules rules{
        .variance = before / 3, .directCost = 1, .linkCost = 16, .mostSamplePasses = 4096, .hasDirect = true};
    const ChunkPlan plan = planChunks(rules, chunks, now);
    double left = 0;
    for (size_t i = 0; i < chunks.size(); ++i)
        left += chunks[i].indirect * now.links[i] / plan.links[i];
    EXPECT_LE(left, rules.variance);
    EXPECT_GE(left, 0.5 * rules.variance) << "no more than the ladder's steps beyond it";
    EXPECT_GT(plan.links.back(), 2 * plan.links.front());
}

TEST(ChunkPlan, MostSamplePassesAreKept) {
    const std::vector<ChunkVariance> chunks(3, off(1.0, 1.0));
    ChunkPlanRules rules = local(0.001);
    rules.mostSamplePasses = 5;
    const ChunkPlan plan = planChunks(rules, chunks, after(3, 4, 5));
    for (const uint32_t samplePasses : plan.direct)
        EXPECT_LE(samplePasses, 5u);
    EXPECT_EQ(plan.links, std::vector<uint32_t>(3, 5));
}

} // namespace
} // namespace relume
