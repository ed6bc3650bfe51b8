#include "bake/base/chunk_rounds.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

TEST(ChunkRounds, EveryChunkTakesOneMoreTogether) {
    ChunkRounds rounds(3);
    EXPECT_FALSE(rounds.pending());
    for (uint32_t round = 0; round < 4; ++round) {
        rounds.wantOneMore();
        ASSERT_TRUE(rounds.pending());
        const ChunkRounds::Pass pass = rounds.next(8);
        EXPECT_TRUE(pass.all);
        EXPECT_EQ(pass.first, round);
        EXPECT_EQ(pass.count, 1u);
        rounds.finish(pass);
    }
    EXPECT_FALSE(rounds.pending());
    EXPECT_EQ(rounds.deepest(), 4u);
    EXPECT_EQ(rounds.total(), 12u);
}

TEST(ChunkRounds, ThoseBehindCatchUpFirst) {
    ChunkRounds rounds(4);
    rounds.want(std::vector<uint32_t>{2, 2, 6, 0});
    const ChunkRounds::Pass first = rounds.next(16);
    EXPECT_EQ(first.count, 2u) << "as many as all of them want";
    EXPECT_EQ(first.chunks, (std::vector<uint8_t>{1, 1, 1, 0}));
    EXPECT_FALSE(first.all);
    rounds.finish(first);
    const ChunkRounds::Pass second = rounds.next(3);
    EXPECT_EQ(second.first, 2u);
    EXPECT_EQ(second.count, 3u) << "no more than are allowed";
    EXPECT_EQ(second.chunks, (std::vector<uint8_t>{0, 0, 1, 0}));
}

TEST(ChunkRounds, WantingLessThanThereIsMeansNoMore) {
    ChunkRounds rounds(2);
    rounds.want(std::vector<uint32_t>{4, 4});
    rounds.finish(rounds.next(16));
    rounds.want(std::vector<uint32_t>{1, 4});
    EXPECT_FALSE(rounds.pending());
    EXPECT_EQ(rounds.done()[0], 4u);
}

// A thousand plans at random: every chunk takes each of its sample passes once, in order.
TEST(ChunkRounds, NoSamplePassIsLeftOutOrTakenTwice) {
    std::mt19937 random(7);
    constexpr uint32_t kChunks = 9;
    ChunkRounds rounds(kChunks);
    std::vector<uint32_t> taken(kChunks, 0), most(kChunks, 0);
    for (int plan = 0; plan < 1000; ++plan) {
        std::vector<uint32_t> wanted;
        for (uint32_t i = 0; i < kChunks; ++i) {
            wanted.push_back(taken[i] + random() % 5);
            most[i] = std::max(most[i], wanted[i]);
        }
        rounds.want(wanted);
        while (rounds.pending()) {
            const ChunkRounds::Pass pass = rounds.next(1 + random() % 4);
            ASSERT_GT(pass.count, 0u);
            for (uint32_t i = 0; i < kChunks; ++i) {
                if (pass.chunks[i] == 0) continue;
                ASSERT_EQ(pass.first, taken[i]);
                taken[i] += pass.count;
            }
            rounds.finish(pass);
        }
        ASSERT_EQ(taken, most);
    }
}

} // namespace
} // namespace relume
