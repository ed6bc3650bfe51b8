#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bake/ranks/chunk_deal.h"
#include "bake/surface/patch_set.h"
#include "bake/trace/tracer.h"

namespace relume {

/// The things that a search for what stands in texels works with.
struct CoverSearch {
    const vk::Device& device;
    Tracer& tracer;
    PatchSet& patches;
    // The patches and their covers on the device, whose cells play no part: for tracers that record.
    const vk::Buffer* devicePatches = nullptr;
    const vk::Buffer* deviceCovers = nullptr;
    std::function<void(double done)> onBatch = {}; // before each batch; what it throws ends the search
    uint32_t mostChunks = ~0u;                     // that a batch spans, where buffers are kept for long
};

/// Returns the patches some of whose samples may start elsewhere than at their own point, ascending.
std::vector<uint32_t> coveredPatches(const PatchSet& patches, WorkerPool& pool);

/// Returns those of these patches (ascending) that lie in these chunks (ascending runs).
std::vector<uint32_t> patchesIn(std::span<const ChunkRange> chunks, std::span<const uint32_t> patches);

/// Brings to all ranks the cells of these patches' covers (ascending, the same ones on all ranks), which each
/// has found in its own chunks. The rest of a cover all ranks have.
void shareCells(Ranks& ranks, const ChunkDeal& dealt, std::span<const uint32_t> which, PatchSet& patches,
                WorkerPool& pool);

/// Searches for what stands in texels. It keeps its buffers, and what it learns of the device's speed, from
/// one search to the next.
class CoverSearcher {
public:
    explicit CoverSearcher(const CoverSearch& on);
    ~CoverSearcher();

    const CoverSearch& on() const { return on_; }
    /// Takes those cells away from the covers of these patches (ascending) that their own point does not see:
    /// a wall stands in front of them, or they lie inside something. The covers begin with what the surface
    /// has. Returns the patches whose cover is another one than before, ascending.
    std::vector<uint32_t> search(std::span<const uint32_t> which);
    /// Gives its buffers up, until the next search.
    void release();

private:
    class Batches;
    CoverSearch on_;
    std::unique_ptr<Batches> batches_; // once there is something to search for
};

/// Returns the device bytes that it takes, on a software device or a GPU.
uint64_t coverSearchBytes(uint32_t chunks, bool software);

} // namespace relume
