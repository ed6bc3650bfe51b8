#pragma once

#include "bake/base/chunk_sample_passes.h"
#include "bake/gather/link_kit.h"

namespace relume {

/// Chunks whose direct light is made at once: `range` counts in `chunks`, or in all where that is nullptr.
struct DirectPortion {
    ChunkRange range;
    const vk::Buffer* chunks = nullptr; // uint32_t[]
};

/// Returns how many of `left` (> 0) sample passes from `first` on are made at once: a power of two, whose
/// multiples they begin at, as EmitterLight::Work and LampLight::Work want it. Their replicates know better
/// which share of a light is seen, and kernels have more to do.
uint32_t samplePassesAtOnce(uint32_t first, uint32_t left);

/// Takes the chunks of a pass of direct light out of the order, portion by portion: neighbouring ones where
/// this process makes all, else any, by a list that kernels read. A GPU would take some 0.3 ms for each
/// range of neighbouring ones, and the threads of a CPU would wait for each other.
class DirectPortions {
public:
    explicit DirectPortions(LinkKit& kit) : kit_(kit), rate_(kit.wide()) {}

    /// Begins a submit of portions of this pass, of at most so many chunks of one sample pass at a time; what
    /// was recorded of the one before is done.
    void begin(const ChunkSamplePasses::Pass& pass, uint32_t most);
    /// Takes the next one; call it where chunks are left. What it says is valid until begin().
    DirectPortion next();
    /// Tells whether another portion is worth its place in the submit.
    bool wantsMore() const;
    /// Takes note of how long the submit took.
    void end(double seconds) { rate_.note(done_, kit_.batchMs, seconds); }

private:
    uint32_t mostListed() const;
    DirectPortion list(uint32_t most);

    LinkKit& kit_;
    BatchRate rate_;  // of chunks in one sample pass
    vk::Buffer list_; // uint32_t per chunk; made at first use
    uint32_t listed_ = 0;
    bool neighbours_ = true;
    uint32_t samplePasses_ = 1, most_ = 1;
    double wanted_ = 0, done_ = 0; // chunks, once for each sample pass
};

} // namespace relume
