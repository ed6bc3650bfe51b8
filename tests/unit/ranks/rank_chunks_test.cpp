// The chunks that ranks bring each other, because smoothing reads across their borders.
#include "bake/gather/rank_chunks.h"

#include <gtest/gtest.h>

#include <numeric>

namespace relume {
namespace {

// A lightmap of so many tiles along each edge, each of which is a chunk.
TraceScene tiledScene(uint32_t tiles) {
    TraceScene scene;
    scene.size = tiles * kTileTexels;
    for (uint32_t tile = 0; tile < tiles * tiles; ++tile)
        for (uint32_t lane = 0; lane < shader::kChunk; ++lane) {
            const uint32_t x = tile % tiles * kTileTexels + lane % kTileTexels;
            const uint32_t y = tile / tiles * kTileTexels + lane / kTileTexels;
            scene.patches.push_back({});
            scene.patches.back().flags = (y * scene.size + x) << shader::kTexelShift;
        }
    return scene;
}

TEST(NearChunks, areThoseOfTheTilesAround) {
    constexpr uint32_t kTiles = 8;
    WorkerPool pool(2);
    const TraceScene scene = tiledScene(kTiles);
    const ChunkDeal deal(kTiles * kTiles, 2, {.least = 32}); // the upper half, the lower half
    ASSERT_EQ(deal.runsOf(0).size(), 1u);
    const NearChunks first = nearChunks(pool, scene, deal, 0), second = nearChunks(pool, scene, deal, 1);
    std::vector<uint32_t> lastRow(kTiles), nextRow(kTiles);
    std::iota(lastRow.begin(), lastRow.end(), 3 * kTiles);
    std::iota(nextRow.begin(), nextRow.end(), 4 * kTiles);
    EXPECT_EQ(first.to[1], lastRow);
    EXPECT_EQ(first.from[1], nextRow);
    EXPECT_TRUE(first.to[0].empty() && first.from[0].empty());
    for (uint32_t chunk = 0; chunk < kTiles * kTiles; ++chunk) {
        EXPECT_EQ(first.rows[chunk], chunk < 5 * kTiles ? 1 : 0);
        EXPECT_EQ(second.rows[chunk], chunk >= 3 * kTiles ? 1 : 0);
    }
}

TEST(NearChunks, areSentAsTheyAreExpected) {
    WorkerPool pool(2);
    const TraceScene scene = tiledScene(12);
    for (const uint32_t ranks : {2u, 3u, 5u}) {
        const ChunkDeal deal(144, ranks, {.least = 7, .most = 8});
        std::vector<NearChunks> near;
        for (uint32_t rank = 0; rank < ranks; ++rank)
            near.push_back(nearChunks(pool, scene, deal, rank));
        for (uint32_t a = 0; a < ranks; ++a)
            for (uint32_t b = 0; b < ranks; ++b) {
                EXPECT_EQ(near[a].to[b], near[b].from[a]);
                for (const NearChunks& one : near)
                    EXPECT_EQ(one.counts[a * ranks + b], near[a].to[b].size());
            }
    }
}

} // namespace
} // namespace relume
