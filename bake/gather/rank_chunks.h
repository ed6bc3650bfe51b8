#pragma once

#include <functional>
#include <span>
#include <vector>

#include "assets/base/worker_pool.h"
#include "bake/gather/shared_stage.h"
#include "bake/ranks/chunk_deal.h"
#include "bake/surface/patch_set.h"
#include "bake/vk/buffer.h"
#include "bake/vk/commands.h"

namespace relume {

/// Chunks that ranks send each other, because smoothing reads patches of a lightmap's neighbouring tiles.
/// Chunks are ascending.
struct NearChunks {
    std::vector<uint8_t> rows;               // 1: its rows are read by what this rank smooths
    std::vector<std::vector<uint32_t>> to;   // those that this rank sends to each other one
    std::vector<std::vector<uint32_t>> from; // those that it receives from each other one
    std::vector<uint32_t> counts;            // [from * ranks + to]: how many go from any rank to any other
};
/// Finds them for a rank: the chunks that have a patch in the tiles around those of a chunk of its own, on
/// all eight sides. Smoothing looks no further than a tile (smoothingReach()).
NearChunks nearChunks(WorkerPool& pool, const TraceScene& scene, const ChunkDeal& deal, uint32_t rank);

/// The chunks that this process bakes, all of them where it works alone, and what it and other ranks bring
/// each other of buffers on their devices: through memory of the host, which those of one machine
/// share. All ranks make the same calls.
class RankChunks {
public:
    RankChunks(const vk::Device& device, Ranks& ranks, const PatchSet& patches);

    bool alone() const { return ranks_.alone(); }
    Ranks& ranks() const { return ranks_; }
    const ChunkDeal& deal() const { return deal_; }
    /// Returns the runs of this rank's chunks.
    std::span<const ChunkRange> own() const { return deal_.runsOf(ranks_.rank()); }
    /// Returns the chunks whose links this rank keeps; none where it works alone and keeps those of all.
    std::vector<ChunkRange> linked() const {
        return alone() ? std::vector<ChunkRange>() : std::vector<ChunkRange>(own().begin(), own().end());
    }
    /// Returns the chunks whose patches are smoothed along rows: its own, and those beside them.
    const std::vector<ChunkRange>& rows() const { return rows_; }
    /// Returns a mark per chunk for each of these; none where this process works alone.
    std::span<const uint8_t> rowMarks() const { return near_.rows; }
    /// Returns those of the chunks that are marked which are its own, with one mark per chunk.
    std::vector<uint8_t> ownOf(std::vector<uint8_t> marks) const;

    /// A buffer of `arrays` arrays one behind the other, each of so many bytes per chunk.
    struct Shared {
        const vk::Buffer& buffer;
        VkDeviceSize chunkBytes = 0;
        uint32_t arrays = 1;
    };
    /// Brings to all ranks what each has in its own chunks of a buffer. Waits for the device.
    void share(const Shared& shared);
    /// Brings to each rank what others have in chunks near its own.
    void shareNear(const Shared& shared);
    /// Brings to all ranks what each has in its own chunks of an array in host memory.
    template<typename T>
    void share(std::vector<T>& array) {
        if (!alone() && !array.empty())
            shareHost(std::as_writable_bytes(std::span(array)), array.size() / deal_.chunks() * sizeof(T));
    }

private:
    /// Something that is copied between a buffer and the host.
    using Regions = std::vector<VkBufferCopy>;
    void reserve(vk::Buffer& staging, VkDeviceSize bytes) const;
    void shareHost(std::span<std::byte> array, uint64_t chunkBytes);
    void copy(const vk::Buffer& from, const vk::Buffer& to, const Regions& regions);
    /// Tells where chunks of a buffer stand among all bytes that ranks bring each other: those that this rank
    /// sends, and those that it receives, as they go out.
    struct Ways {
        Regions out, in;
    };
    bool goByStage(const vk::Buffer& buffer, VkDeviceSize bytes, const Ways& ways);
    bool shareByStage(const Shared& shared, VkDeviceSize arrayStart);
    void shareByMessages(const Shared& shared, VkDeviceSize arrayStart);
    void run(const std::function<void(VkCommandBuffer)>& record);
    bool shareNearByStage(const Shared& shared);
    static VkDeviceSize appendRanges(Regions& regions, std::span<const ChunkRange> ranges,
                                     VkDeviceSize chunkBytes, VkDeviceSize arrayStart, VkDeviceSize at);

    const vk::Device& device_;
    Ranks& ranks_;
    ChunkDeal deal_;
    NearChunks near_;
    std::vector<ChunkRange> rows_;
    vk::Commands commands_;
    SharedStage stage_;
    vk::Buffer sent_, received_; // host memory where there is no stage, as large as they were needed so far
};

} // namespace relume
