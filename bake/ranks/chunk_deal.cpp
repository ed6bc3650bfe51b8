#include "bake/ranks/chunk_deal.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cstring>

namespace relume {
namespace {

constexpr uint64_t kMostRuns = 8; // of a rank: more of them have more neighbours in other ranks' hands

} // namespace

ChunkDeal::ChunkDeal(uint32_t chunks, uint32_t ranks, uint32_t leastRun) : chunks_(chunks), runs_(ranks) {
    ASSERT(ranks > 0 && leastRun > 0);
    const uint64_t perRank = std::clamp<uint64_t>(chunks / (uint64_t{ranks} * leastRun), 1, kMostRuns);
    const uint64_t runs = ranks == 1 ? 1 : ranks * perRank;
    for (uint64_t i = 0; i < runs; ++i) {
        const auto first = static_cast<uint32_t>(i * chunks / runs);
        const auto end = static_cast<uint32_t>((i + 1) * chunks / runs);
        if (first < end) runs_[i % ranks].push_back({first, end - first});
    }
}

uint32_t ChunkDeal::chunksOf(uint32_t rank) const {
    uint32_t count = 0;
    for (const ChunkRange& run : runs_[rank])
        count += run.count;
    return count;
}

std::vector<uint32_t> ChunkDeal::owners() const {
    std::vector<uint32_t> owners(chunks_, 0);
    for (uint32_t rank = 0; rank < ranks(); ++rank)
        for (const ChunkRange& run : runs_[rank])
            std::fill_n(owners.begin() + run.first, run.count, rank);
    return owners;
}

void shareChunks(Ranks& ranks, const ChunkDeal& deal, std::span<std::byte> array, uint64_t chunkBytes) {
    if (ranks.alone()) return;
    ASSERT(deal.ranks() == ranks.count() && array.size() == deal.chunks() * chunkBytes);
    std::vector<uint64_t> sizes;
    for (uint32_t rank = 0; rank < ranks.count(); ++rank)
        sizes.push_back(deal.chunksOf(rank) * chunkBytes);
    std::vector<std::byte> own(sizes[ranks.rank()]), all(array.size());
    auto* to = own.data();
    for (const ChunkRange& run : deal.runsOf(ranks.rank())) {
        std::memcpy(to, array.data() + run.first * chunkBytes, run.count * chunkBytes);
        to += run.count * chunkBytes;
    }
    ranks.gather(own, all, sizes);
    const auto* from = all.data();
    for (uint32_t rank = 0; rank < ranks.count(); ++rank)
        for (const ChunkRange& run : deal.runsOf(rank)) {
            std::memcpy(array.data() + run.first * chunkBytes, from, run.count * chunkBytes);
            from += run.count * chunkBytes;
        }
}

} // namespace relume
