#pragma once

#include <functional>
#include <vector>

#include "bake/base/batch_rate.h"
#include "bake/base/chunk_order.h"
#include "bake/gather/host_smoothing.h"
#include "bake/gather/link_passes.h"
#include "bake/gather/rank_chunks.h"
#include "bake/vk/commands.h"

namespace relume {

/// Holds what the parts of a solver that gathers over links work with: what is baked, the buffers of what is
/// under way, commands, the order of chunks and the counters.
class LinkKit {
public:
    /// A submit holds at most so many portions of a pass: marks of time are between them.
    static constexpr uint32_t kMostPortions = 32;

    struct Desc {
        SolverSettings settings;
        uint32_t linksOfSamplePass = 16; // links per patch and sample pass
        LinkBuffers::Desc buffers;
        uint32_t chunks = 0;      // at most in a pass
        SolverProgress& progress; // the solver's, as the aim is; both must outlive the kit
        const double& batchMs;    // aim of one submit
    };
    LinkKit(const SolverInput& input, const Desc& desc);

    const SolverInput input;
    const SolverSettings settings;
    const uint32_t linksOfSamplePass;
    LinkBuffers buffers;
    RankChunks rankChunks; // that this process bakes
    LinkGatherPass gatherPass;
    vk::Commands commands;
    vk::Timestamps timestamps;
    ChunkOrder order;          // of the pass under way
    std::vector<uint8_t> seen; // chunks that come first
    SolverProgress& progress;
    const double& batchMs; // aim of one submit

    uint32_t chunkCount() const { return input.patches.chunkCount(); }
    /// Returns where samples start (ClosestWork::covers).
    const vk::Buffer* covers() const { return input.light.coversIf(settings.links.allOver); }
    VkDeviceSize lightBytes() const { return LightBuffers::lightBytes(input.patches); }
    /// Tells whether the device may be wider than a batch (BatchRate).
    bool wide() const { return !input.device.info().software(); }
    /// Tells whether the CPU alone traces, and reads and writes what it works on in place.
    bool tracesOnCpu() const { return gatherPass.onCpu() && !input.tracer.records(); }
    /// Returns how sums over links are smoothed on the host by this width [texels], all chunks of them;
    /// smooths is false where they are only read.
    HostSmoothing smoothing(double sigma, bool smooths) const;
    /// Begins a pass over all chunks.
    void beginPass() { order.begin(chunkCount(), seen); }
    /// Returns the next chunks. cost is that of a chunk over that of those that the rate is of; done is the
    /// number of these in the batch so far.
    ChunkRange nextRange(const BatchRate& rate, uint32_t most, double cost = 1, double done = 0) const;

    /// Makes room for so many bytes that the CPU reads after a submit.
    void reserveBack(VkDeviceSize bytes);
    /// Copies there, whose former contents are over with.
    void recordBack(VkCommandBuffer cmd, const vk::Buffer& from, VkDeviceSize bytes, VkDeviceSize at = 0);
    /// Returns `count` values of what was copied to this place [bytes], for which there must be room; where
    /// the CPU gathers it writes there itself.
    template<typename T>
    T* back(VkDeviceSize at = 0, size_t count = 1) const {
        ASSERT(at + count * sizeof(T) <= back_.size());
        return reinterpret_cast<T*>(back_.as<uint8_t>() + at);
    }
    /// Submits and waits, with the barriers for what comes next and for the CPU.
    void run(VkCommandBuffer cmd);
    /// Does the same, and calls this, where it is something, while the device works.
    void run(VkCommandBuffer cmd, const std::function<void()>& meanwhile);
    /// Reads the counters of rays back and begins to count anew; countRays() takes them into the progress
    /// after the submit.
    void recordRayCount(VkCommandBuffer cmd);
    void countRays();

    /// Makes the counters of rays and links in the progress those of all ranks, which have counted theirs
    /// since the call before.
    void shareCounters();
    /// Takes note of counters that all ranks have alike.
    void noteCounters();

private:
    vk::Buffer back_;                                             // sums per chunk, or counters of rays
    uint64_t sharedRays_ = 0, sharedSaved_ = 0, sharedPairs_ = 0; // as all ranks have had them last
};

} // namespace relume
