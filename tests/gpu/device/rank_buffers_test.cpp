// Ranks bring each other parts of buffers on their devices, through memory that they share and by messages.
#include "bake/gather/rank_chunks.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/unit/ranks/thread_ranks.h"

#include <gtest/gtest.h>

#include <atomic>

namespace relume {
namespace {

constexpr uint32_t kTiles = 12, kChunks = kTiles * kTiles;

// A lightmap of so many tiles along each edge, each of which is a chunk.
PatchSet tiledPatches() {
    PatchSet patches;
    patches.scene.size = kTiles * kTileTexels;
    for (uint32_t chunk = 0; chunk < kChunks; ++chunk)
        for (uint32_t lane = 0; lane < shader::kChunk; ++lane) {
            const uint32_t x = chunk % kTiles * kTileTexels + lane % kTileTexels;
            const uint32_t y = chunk / kTiles * kTileTexels + lane / kTileTexels;
            patches.scene.patches.push_back({});
            patches.scene.patches.back().flags = (y * patches.scene.size + x) << shader::kTexelShift;
        }
    return patches;
}

// A word of a chunk has this value once its rank has written it; each call has other ones.
uint32_t wordOf(uint32_t call, uint32_t chunk, uint32_t word) {
    return (call * kChunks + chunk) * 7919 + word;
}

struct SharedWords {
    uint32_t ranks, arrays, wordsOfChunk;
    bool memory;
};

std::string nameOfWords(const testing::TestParamInfo<SharedWords>& test) {
    const SharedWords& words = test.param;
    return std::to_string(words.ranks) + "ranks" + std::to_string(words.arrays) + "arrays" +
           std::to_string(words.wordsOfChunk) + "words" + (words.memory ? "InMemory" : "ByMessages");
}

class RankBuffers : public testing::TestWithParam<SharedWords> {
protected:
    size_t words() const { return size_t{kChunks} * GetParam().wordsOfChunk; }
    VkDeviceSize chunkBytes() const { return GetParam().wordsOfChunk * sizeof(uint32_t); }

    /// Returns the arrays as one rank has them: its own chunks written, the others not.
    std::vector<uint32_t> ownWords(const RankChunks& chunks, uint32_t call) const {
        std::vector<uint32_t> values(words() * GetParam().arrays, 0);
        for (uint32_t array = 0; array < GetParam().arrays; ++array)
            for (const ChunkRange& run : chunks.own())
                for (uint32_t chunk = run.first; chunk < run.first + run.count; ++chunk)
                    for (uint32_t word = 0; word < GetParam().wordsOfChunk; ++word)
                        values[array * words() + size_t{chunk} * GetParam().wordsOfChunk + word] =
                            wordOf(call + array, chunk, word);
        return values;
    }

    /// Counts the chunks that are wanted and are not there as their ranks have written them.
    template<typename Wanted>
    uint32_t missing(const std::vector<uint32_t>& values, uint32_t call, const Wanted& wanted) const {
        uint32_t count = 0;
        for (uint32_t array = 0; array < GetParam().arrays; ++array)
            for (uint32_t chunk = 0; chunk < kChunks; ++chunk) {
                bool right = true;
                for (uint32_t word = 0; word < GetParam().wordsOfChunk && right; ++word)
                    right = values[array * words() + size_t{chunk} * GetParam().wordsOfChunk + word] ==
                            wordOf(call + array, chunk, word);
                if (wanted(chunk) && !right) ++count;
            }
        return count;
    }
};

TEST_P(RankBuffers, AreTheSameOfAllRanks) {
    const PatchSet patches = tiledPatches();
    const vk::Device& device = testDevice();
    std::atomic<uint32_t> all = 0, near = 0, host = 0;
    runThreadRanks(
        GetParam().ranks,
        [&](Ranks& ranks) {
            RankChunks chunks(device, ranks, patches);
            const auto upload = [&](uint32_t call) {
                return vk::makeBuffer(device, ownWords(chunks, call), "words");
            };
            const auto wordsIn = [&](const vk::Buffer& buffer) {
                return vk::readBuffer<uint32_t>(device, buffer, words() * GetParam().arrays);
            };
            for (uint32_t call = 0; call < 3; ++call) { // memory is used again
                const vk::Buffer buffer = upload(call);
                chunks.share({buffer, chunkBytes(), GetParam().arrays});
                all += missing(wordsIn(buffer), call, [](uint32_t) { return true; });
                const vk::Buffer others = upload(call);
                chunks.shareNear({others, chunkBytes(), GetParam().arrays});
                const NearChunks known =
                    nearChunks(device.workers(), patches.scene, chunks.deal(), ranks.rank());
                near +=
                    missing(wordsIn(others), call, [&](uint32_t chunk) { return known.rows[chunk] != 0; });
                if (GetParam().arrays > 1) continue;
                std::vector<uint32_t> values = ownWords(chunks, call);
                chunks.share(values);
                host += missing(values, call, [](uint32_t) { return true; });
            }
        },
        GetParam().memory);
    EXPECT_EQ(all, 0u);
    EXPECT_EQ(near, 0u);
    EXPECT_EQ(host, 0u);
}

// A chunk of 200 KB makes two portions of an array, and several of what is near; the last one is not full.
INSTANTIATE_TEST_SUITE_P(All, RankBuffers,
                         testing::Values(SharedWords{2, 1, 64, true}, SharedWords{3, 4, 256, true},
                                         SharedWords{2, 1, 50000, true}, SharedWords{3, 2, 50000, true},
                                         SharedWords{3, 2, 64, false}),
                         nameOfWords);

} // namespace
} // namespace relume
