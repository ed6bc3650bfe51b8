// Processes that bake together: what a launcher says, how chunks are dealt, and that all ranks have the same
// after each call, or the same end.
#include "bake/ranks/chunk_deal.h"
#include "bake/ranks/launch.h"
#include "tests/unit/ranks/thread_ranks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <string>

namespace relume {
namespace {

using Variables = std::map<std::string, std::string>;

Launch launchIn(const Variables& variables) {
    return launchOf([&](const char* name) -> const char* {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
    });
}

TEST(Launch, withoutALauncherThereIsOneProcess) {
    const Launch launch = launchIn({{"HOME", "/home/somebody"}});
    EXPECT_FALSE(launch.byLauncher);
    EXPECT_FALSE(launch.several());
    EXPECT_TRUE(launch.speaks());
}

TEST(Launch, mpirunSaysWhichProcessThisIs) {
    const Launch launch = launchIn({{"OMPI_COMM_WORLD_RANK", "5"},
                                    {"OMPI_COMM_WORLD_SIZE", "8"},
                                    {"OMPI_COMM_WORLD_LOCAL_RANK", "1"},
                                    {"OMPI_COMM_WORLD_LOCAL_SIZE", "4"}});
    EXPECT_TRUE(launch.byLauncher && launch.several());
    EXPECT_FALSE(launch.speaks());
    EXPECT_EQ(launch.rank, 5u);
    EXPECT_EQ(launch.count, 8u);
    EXPECT_EQ(launch.localRank, 1u);
    EXPECT_EQ(launch.localCount, 4u);
}

TEST(Launch, srunSaysItByPmiOrPmix) {
    for (const char* rank : {"PMI_RANK", "PMIX_RANK"}) {
        const Launch launch = launchIn({{rank, "3"},
                                        {"SLURM_STEP_NUM_TASKS", "4"},
                                        {"SLURM_LOCALID", "1"},
                                        {"SLURM_STEP_TASKS_PER_NODE", "2(x2)"}});
        EXPECT_EQ(launch.rank, 3u) << rank;
        EXPECT_EQ(launch.count, 4u) << rank;
        EXPECT_EQ(launch.localRank, 1u) << rank;
        EXPECT_EQ(launch.localCount, 2u) << rank;
    }
}

TEST(Launch, aScriptInAnAllocationAndTasksThatCannotSpeakAreAlone) {
    EXPECT_FALSE(launchIn({{"SLURM_NTASKS", "8"}, {"SLURM_PROCID", "0"}}).several());
    EXPECT_FALSE(launchIn({{"SLURM_STEP_NUM_TASKS", "8"}, {"SLURM_PROCID", "3"}}).several());
}

TEST(Launch, whatIsNoNumberOrNoRankIsNotHeeded) {
    EXPECT_FALSE(launchIn({{"OMPI_COMM_WORLD_RANK", "x"}, {"OMPI_COMM_WORLD_SIZE", "2"}}).several());
    EXPECT_FALSE(launchIn({{"OMPI_COMM_WORLD_RANK", "2"}, {"OMPI_COMM_WORLD_SIZE", "2"}}).several());
    EXPECT_FALSE(launchIn({{"OMPI_COMM_WORLD_RANK", ""}, {"OMPI_COMM_WORLD_SIZE", "2"}}).several());
}

TEST(Launch, aProcessHasTheCoresThatItIsBoundToOrItsShare) {
    EXPECT_EQ(threadShare({4, 16}, 4), 4u);  // bound
    EXPECT_EQ(threadShare({16, 16}, 4), 4u); // not bound
    EXPECT_EQ(threadShare({2, 2}, 5), 1u);
    EXPECT_EQ(threadShare({16, 16}, 1), 16u);
    EXPECT_TRUE(boundTight({1, 16}, 4)); // as mpirun binds two processes
    EXPECT_FALSE(boundTight({4, 16}, 4));
    EXPECT_FALSE(boundTight({16, 16}, 4));
    EXPECT_FALSE(boundTight({1, 2}, 2));
}

TEST(ChunkDeal, everyChunkIsBakedByOneRank) {
    for (const uint32_t chunks : {1u, 7u, 64u, 1000u, 262144u})
        for (const uint32_t ranks : {1u, 2u, 3u, 5u, 16u})
            for (const uint32_t leastRun : {1u, 32u, 4096u}) {
                const ChunkDeal deal(chunks, ranks, {.least = leastRun, .most = 8});
                std::vector<uint32_t> times(chunks, 0);
                uint32_t all = 0;
                for (uint32_t rank = 0; rank < ranks; ++rank) {
                    uint32_t last = 0, own = 0;
                    for (const ChunkRange& run : deal.runsOf(rank)) {
                        EXPECT_TRUE(run.first >= last && run.count > 0);
                        last = run.first + run.count;
                        own += run.count;
                        for (uint32_t chunk = run.first; chunk < last; ++chunk)
                            ++times.at(chunk);
                        EXPECT_EQ(deal.owners().at(run.first), rank);
                    }
                    EXPECT_EQ(deal.chunksOf(rank), own);
                    all += own;
                }
                EXPECT_EQ(all, chunks);
                EXPECT_EQ(std::count(times.begin(), times.end(), 1u), chunks);
            }
}

TEST(ChunkDeal, ranksHaveAsMuchInSeveralLongRuns) {
    const ChunkDeal deal(1024, 3, {.least = 32, .most = 8});
    for (uint32_t rank = 0; rank < 3; ++rank) {
        EXPECT_EQ(deal.runsOf(rank).size(), 8u);
        EXPECT_NEAR(deal.chunksOf(rank), 1024.0 / 3.0, 8.0);
    }
    EXPECT_EQ(ChunkDeal(1024, 3, {.least = 32, .most = 64}).runsOf(2).size(), 10u);
    EXPECT_EQ(ChunkDeal(1024, 4, {.least = 512, .most = 8}).runsOf(2).size(), 1u);
    EXPECT_EQ(ChunkDeal(1024, 1, {.least = 32, .most = 8}).runsOf(0).size(), 1u);
}

TEST(Ranks, oneProcessHasAllOfEverything) {
    Ranks& one = oneProcess();
    EXPECT_TRUE(one.alone() && one.speaks());
    EXPECT_EQ(one.sum(7), 7u);
    const std::vector<std::byte> own = {std::byte{1}, std::byte{2}};
    std::vector<std::byte> all(2);
    const std::vector<uint64_t> sizes = {2};
    one.gather(own, all, sizes);
    EXPECT_EQ(all, own);
    one.finish();
    EXPECT_TRUE(one.fail()); // nobody else can tell
}

TEST(Ranks, allHaveTheSameSumsAndChunks) {
    constexpr uint32_t kChunks = 103;
    for (const uint32_t count : {2u, 3u, 5u, 120u}) {
        std::vector<std::vector<uint32_t>> arrays(count);
        std::vector<uint64_t> sums(count);
        runThreadRanks(count, [&](Ranks& ranks) {
            const ChunkDeal deal(kChunks, count, {.least = 4, .most = 8});
            std::vector<uint32_t> array(size_t{2} * kChunks, 0); // two values per chunk
            for (const ChunkRange& run : deal.runsOf(ranks.rank()))
                for (uint32_t chunk = run.first; chunk < run.first + run.count; ++chunk)
                    array[size_t{2} * chunk] = chunk, array[size_t{2} * chunk + 1] = 1000 + chunk;
            shareChunks(ranks, deal, array);
            arrays[ranks.rank()] = array;
            sums[ranks.rank()] = ranks.sum(ranks.rank() + 1);
            ranks.finish();
        });
        for (uint32_t rank = 0; rank < count; ++rank) {
            EXPECT_EQ(sums[rank], uint64_t{count} * (count + 1) / 2);
            for (uint32_t chunk = 0; chunk < kChunks; ++chunk) {
                EXPECT_EQ(arrays[rank][size_t{2} * chunk], chunk);
                EXPECT_EQ(arrays[rank][size_t{2} * chunk + 1], 1000 + chunk);
            }
        }
    }
}

TEST(Ranks, messagesReachWhomTheyAreFor) {
    constexpr uint32_t kCount = 4;
    std::vector<std::vector<std::byte>> got(kCount);
    runThreadRanks(kCount, [&](Ranks& ranks) {
        // Each one sends to the next one, as many bytes as its number says.
        const uint32_t to = (ranks.rank() + 1) % kCount, from = (ranks.rank() + kCount - 1) % kCount;
        const std::vector<std::byte> text(ranks.rank() + 1, std::byte(ranks.rank()));
        got[ranks.rank()].resize(from + 1);
        const std::vector<Ranks::Sent> sent = {{to, text}};
        const std::vector<Ranks::Received> received = {{from, got[ranks.rank()]}};
        ranks.exchange(sent, received);
    });
    for (uint32_t rank = 0; rank < kCount; ++rank) {
        const uint32_t from = (rank + kCount - 1) % kCount;
        EXPECT_EQ(got[rank], std::vector<std::byte>(from + 1, std::byte(from)));
    }
}

// Some fail at once, the others in the midst of their work: all end, and one tells.
TEST(Ranks, theFirstOfThoseThatFailTellsAndTheOthersLearnOfIt) {
    for (const std::vector<uint32_t>& failing :
         {std::vector<uint32_t>{0}, std::vector<uint32_t>{3}, std::vector<uint32_t>{1, 3},
          std::vector<uint32_t>{0, 1, 2, 3}}) {
        std::atomic<uint32_t> told = 0, learnt = 0, teller = 99;
        runThreadRanks(4, [&](Ranks& ranks) {
            const bool fails = std::find(failing.begin(), failing.end(), ranks.rank()) != failing.end();
            EXPECT_EQ(ranks.sum(1), 4u);
            if (fails) {
                if (!ranks.fail()) return;
                ++told;
                teller = ranks.rank();
                return;
            }
            try {
                ranks.sum(1);
                ADD_FAILURE() << "the work went on";
            } catch (const OtherRankFailed&) {
                ++learnt;
            }
        });
        EXPECT_EQ(told, 1u);
        EXPECT_EQ(teller, failing.front());
        EXPECT_EQ(learnt, 4u - failing.size());
    }
}

TEST(Ranks, onesThatAreDoneWaitForThoseThatMayFail) {
    std::atomic<uint32_t> learnt = 0, told = 0;
    runThreadRanks(3, [&](Ranks& ranks) {
        if (ranks.speaks()) {
            told += ranks.fail() ? 1 : 0;
            return;
        }
        EXPECT_THROW(ranks.finish(), OtherRankFailed);
        ++learnt;
    });
    EXPECT_EQ(told, 1u);
    EXPECT_EQ(learnt, 2u);
}

} // namespace
} // namespace relume
