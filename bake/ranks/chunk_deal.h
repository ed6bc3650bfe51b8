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
    /// Deals `chunks` to `ranks`, to each up to eight runs of no fewer than `leastRun` chunks where there are
    /// so many.
    ChunkDeal(uint32_t chunks, uint32_t ranks, uint32_t leastRun);

    uint32_t ranks() const { return static_cast<uint32_t>(runs_.size()); }
    uint32_t chunks() const { return chunks_; }
    /// Returns the runs of a rank, ascending and apart; none where there are more ranks than chunks.
    std::span<const ChunkRange> runsOf(uint32_t rank) const { return runs_[rank]; }
    uint32_t chunksOf(uint32_t rank) const;
    /// Returns the rank of each chunk.
    std::vector<uint32_t> owners() const;

    /// Returns the least run for a device: a GPU needs long ones to be filled by a batch.
    static uint32_t leastRunOf(bool software) { return software ? 32 : 4096; }

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
