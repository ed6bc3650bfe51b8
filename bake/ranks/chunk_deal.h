#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/ranks/ranks.h"

namespace relume {

/// Tells which chunks of a lightmap each rank bakes: runs of neighbouring ones, dealt in turn, so that places
/// that cost more than others are shared. It decides no byte of the result.
class ChunkDeal {
public:
    /// How many runs a rank has at most, each of no fewer than so many chunks where there are so many.
    struct Runs {
        uint32_t least = 1; // > 0
        uint32_t most = 1;  // > 0
    };
    ChunkDeal(uint32_t chunks, uint32_t ranks, const Runs& runs);

    uint32_t ranks() const { return static_cast<uint32_t>(runs_.size()); }
    uint32_t chunks() const { return chunks_; }
    /// Returns the runs of a rank, ascending and apart; none where there are more ranks than chunks.
    std::span<const ChunkRange> runsOf(uint32_t rank) const { return runs_[rank]; }
    uint32_t chunksOf(uint32_t rank) const;
    /// Returns the rank of each chunk.
    std::vector<uint32_t> owners() const;

    /// Returns the runs for a kind of device. More of them share what places cost more evenly, and have more
    /// neighbours in other ranks' hands; a GPU's dispatches should not be shorter.
    static Runs runsFor(bool software) { return software ? Runs{32, 8} : Runs{256, 32}; }

private:
    uint32_t chunks_;
    std::vector<std::vector<ChunkRange>> runs_; // of each rank
};

/// Brings to all ranks what each has in its own chunks of an array in host memory, of so many bytes per
/// chunk.
void shareChunks(Ranks& ranks, const ChunkDeal& deal, std::span<std::byte> array, uint64_t chunkBytes);
template<typename T>
void shareChunks(Ranks& ranks, const ChunkDeal& deal, std::vector<T>& array) {
    if (ranks.alone() || array.empty()) return;
    shareChunks(ranks, deal, std::as_writable_bytes(std::span(array)),
                array.size() / deal.chunks() * sizeof(T));
}

} // namespace relume
