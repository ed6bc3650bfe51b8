#include "bake/ranks/chunk_deal.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cstring>

namespace relume {

ChunkDeal::ChunkDeal(uint32_t chunks, uint32_t ranks, const Runs& runs) : chunks_(chunks), runs_(ranks) {
    ASSERT(ranks > 0 && runs.least > 0 && runs.most > 0);
    const uint64_t perRank = std::clamp<uint64_t>(chunks / (uint64_t{ranks} * runs.least), 1, runs.most);
    const uint64_t all = ranks == 1 ? 1 : ranks * perRank;
    for (uint64_t i = 0; i < all; ++i) {
        const auto first = static_cast<uint32_t>(i * chunks / all);
        const auto end = static_cast<uint32_t>((i + 1) * chunks / all);
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
