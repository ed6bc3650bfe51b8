#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "bake/gather/link_cache.h"
#include "bake/gather/link_kit.h"

namespace relume {

/// Batches over links: which chunks come next, their links from the cache or traced anew, and how many of
/// them take the time that a batch may take. The solver says what is gathered over them.
class LinkBatches {
public:
    LinkBatches(LinkKit& kit, const LinkCache::Desc& cache)
        : kit_(kit), cache_(kit.input.device, cache), traceRate_(kit.wide()), gatherRate_(kit.wide()) {}

    /// Chunks whose links are in one place, all of them there or all to be traced.
    struct Portion {
        bool trace = false;
        bool once = false;         // its links are not kept
        uint32_t samplePasses = 1; // sample passes
        ChunkRange range;
        ClosestWork closest;         // where they are to be traced
        LinkGatherPass::Work gather; // links, samples and range
    };
    /// Returns the next portion of the pass over the links of this sample pass. `spent` is the number of
    /// chunks in the batch so far.
    Portion next(uint32_t samplePass, double spent = 0);
    /// Takes the next portions out of the order that make a batch together, of which all are traced or none:
    /// one where this process has all chunks, else several, as the runs of a rank are short for a GPU.
    std::vector<Portion> take(uint32_t samplePass);
    /// Takes the next portion of a pass over links that are read once out of the order, of so many sample
    /// passes from `samplePass` on; mostSamplePasses() at most.
    Portion takeOnce(uint32_t samplePass, uint32_t samplePasses);
    uint32_t mostSamplePasses() const { return std::min(kMostSamplePassesAtOnce, kit_.buffers.batchChunks); }
    /// Notes that these links are there and that their chunks are done.
    void finish(uint32_t samplePass, const Portion& portion);
    void finish(uint32_t samplePass, std::span<const Portion> portions) {
        for (const Portion& portion : portions)
            finish(samplePass, portion);
    }

    /// The solver's share of a batch. Each is called once, in this order; an empty one records nothing.
    struct Steps {
        std::function<void(VkCommandBuffer)> begin;  // ahead of all
        std::function<void(VkCommandBuffer)> traced; // behind the links that were traced
        std::function<void(VkCommandBuffer)> gather; // with a null buffer: at once
        // Behind what was gathered at once: tells whether `end` records.
        std::function<bool()> endRecords;
        std::function<void(VkCommandBuffer)> end; // null where it does not
        std::function<void()> meanwhile;          // while the device works, if it does
    };
    /// Runs a batch of portions that all are traced, or none, and measures it. Where the CPU traces and
    /// gathers there is no submit, which would take longer than a small batch; `atOnce` says that this is
    /// possible for what the steps record.
    void run(std::span<const Portion> portions, const Steps& steps, bool atOnce);
    /// Tells whether the CPU traces and gathers.
    bool onCpu() const { return kit_.tracesOnCpu(); }

    /// Returns how many chunks whose links are there make a batch.
    double wanted() const { return gatherRate_.wanted(kit_.batchMs); }
    /// Takes note of a batch of these that took `seconds`.
    void note(double chunks, double seconds) { gatherRate_.note(chunks, kit_.batchMs, seconds); }
    LinkCache& cache() { return cache_; }
    const LinkCache& cache() const { return cache_; }

private:
    // So many sample passes make a portion of few chunks large enough for a GPU.
    static constexpr uint32_t kMostSamplePassesAtOnce = 16;

    ClosestWork closestWork(uint32_t samplePass, uint32_t samplePasses, const LinkCache::Place& place,
                            ChunkRange range) const;
    void trace(std::span<const Portion> portions, VkCommandBuffer cmd) const;
    void runAtOnce(std::span<const Portion> portions, const Steps& steps);
    /// Returns the time that steps.meanwhile took beyond the device's [s], which is none of the batch's.
    double runBySubmit(std::span<const Portion> portions, const Steps& steps);

    LinkKit& kit_;
    LinkCache cache_;
    BatchRate traceRate_, gatherRate_;
};

} // namespace relume
