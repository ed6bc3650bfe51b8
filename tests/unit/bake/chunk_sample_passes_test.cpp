#include "bake/base/chunk_sample_passes.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

TEST(ChunkSamplePasses, EveryChunkTakesOneMoreTogether) {
    ChunkSamplePasses samplePasses(3);
    EXPECT_FALSE(samplePasses.pending());
    for (uint32_t samplePass = 0; samplePass < 4; ++samplePass) {
        samplePasses.wantOneMore();
        ASSERT_TRUE(samplePasses.pending());
        const ChunkSamplePasses::Pass pass = samplePasses.next(8);
        EXPECT_TRUE(pass.all);
        EXPECT_EQ(pass.first, samplePass);
        EXPECT_EQ(pass.count, 1u);
        samplePasses.finish(pass);
    }
    EXPECT_FALSE(samplePasses.pending());
    EXPECT_EQ(samplePasses.deepest(), 4u);
    EXPECT_EQ(samplePasses.total(), 12u);
}

TEST(ChunkSamplePasses, ThoseBehindCatchUpFirst) {
    ChunkSamplePasses samplePasses(4);
    samplePasses.want(std::vector<uint32_t>{2, 2, 6, 0});
    const ChunkSamplePasses::Pass first = samplePasses.next(16);
    EXPECT_EQ(first.count, 2u) << "as many as all of them want";
    EXPECT_EQ(first.chunks, (std::vector<uint8_t>{1, 1, 1, 0}));
    EXPECT_FALSE(first.all);
    samplePasses.finish(first);
    const ChunkSamplePasses::Pass second = samplePasses.next(3);
    EXPECT_EQ(second.first, 2u);
    EXPECT_EQ(second.count, 3u) << "no more than are allowed";
    EXPECT_EQ(second.chunks, (std::vector<uint8_t>{0, 0, 1, 0}));
}

TEST(ChunkSamplePasses, WantingLessThanThereIsMeansNoMore) {
    ChunkSamplePasses samplePasses(2);
    samplePasses.want(std::vector<uint32_t>{4, 4});
    samplePasses.finish(samplePasses.next(16));
    samplePasses.want(std::vector<uint32_t>{1, 4});
    EXPECT_FALSE(samplePasses.pending());
    EXPECT_EQ(samplePasses.done()[0], 4u);
}

// A thousand plans at random: every chunk takes each of its sample passes once, in order.
TEST(ChunkSamplePasses, NoSamplePassIsLeftOutOrTakenTwice) {
    std::mt19937 random(7);
    constexpr uint32_t kChunks = 9;
    ChunkSamplePasses samplePasses(kChunks);
    std::vector<uint32_t> taken(kChunks, 0), most(kChunks, 0);
    for (int plan = 0; plan < 1000; ++plan) {
        std::vector<uint32_t> wanted;
        for (uint32_t i = 0; i < kChunks; ++i) {
            wanted.push_back(taken[i] + random() % 5);
            most[i] = std::max(most[i], wanted[i]);
        }
        samplePasses.want(wanted);
        while (samplePasses.pending()) {
            const ChunkSamplePasses::Pass pass = samplePasses.next(1 + random() % 4);
            ASSERT_GT(pass.count, 0u);
            for (uint32_t i = 0; i < kChunks; ++i) {
                if (pass.chunks[i] == 0) continue;
                ASSERT_EQ(pass.first, taken[i]);
                taken[i] += pass.count;
            }
            samplePasses.finish(pass);
        }
        ASSERT_EQ(taken, most);
    }
}

} // namespace
} // namespace relume
