#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "assets/base/worker_pool.h"
#include "bake/gather/chunk_plan.h"

namespace relume {

/// Holds what sample passes of direct light are planned by, chunk by chunk.
struct DirectPlanRules {
    double cost = 1;     // of a sample pass, for each patch
    double passCost = 0; // that each sample pass of some chunks has besides
    double linkGain = 0; // what the next sample pass of links takes away of the variance, for its cost, on
                         // the mean over patches: what direct light has to outweigh
    double allowed = 0;  // variance that direct light may leave in all, as left() tells; 0: none
    uint32_t least = 1;  // sample passes that every chunk is to have
    uint32_t most = 1;   // that a chunk may have
};

/// Gives chunks the sample passes of direct light that pay for themselves. Mostly a few patches close to a
/// light have most of the variance, and sample passes of all the others would be in vain.
class DirectPlan {
public:
    /// The threads of the pool share the work; a large lightmap has a million chunks.
    DirectPlan(WorkerPool& pool, uint32_t chunkCount)
        : pool_(pool), ofOne_(chunkCount, 0.0), patches_(chunkCount, 0.0) {}

    /// Learns what a check says of chunks that have so many sample passes; `locally`: of local error. A chunk
    /// is taken for no better than its neighbours, as planChunks does.
    void learn(std::span<const ChunkVariance> chunks, std::span<const uint32_t> samplePasses, bool locally);

    /// Returns the sample passes that each chunk is to have: so many that the last one takes away more of the
    /// variance for its cost than links would, in steps of the ladder (sample_plan.h), no more than
    /// kMostChunkGrowth times what it has, and no more than leave what is allowed. Few chunks have none
    /// where it does not make up for the cost of the sample pass.
    std::vector<uint32_t> wanted(const DirectPlanRules& rules, std::span<const uint32_t> samplePasses) const;

    /// Returns the variance that is left after so many, pooled as it was learned.
    double left(std::span<const uint32_t> samplePasses) const;
    /// Returns that of chunks that have as many as they want.
    double settled(std::span<const uint32_t> wanted, std::span<const uint32_t> samplePasses) const;

    /// Gives the arrays to a stored state.
    std::vector<double>& ofOneArray() { return ofOne_; }
    std::vector<double>& patchesArray() { return patches_; }

private:
    double leftOf(size_t chunk, uint32_t samplePasses) const {
        return ofOne_[chunk] * patches_[chunk] / std::max(1u, samplePasses);
    }
    double gainFor(const DirectPlanRules& rules, std::span<const uint32_t> samplePasses) const;
    uint32_t wantedOf(const DirectPlanRules& rules, size_t chunk, uint32_t now) const;
    /// The chunks that take part in one sample pass.
    struct Part {
        double ofOne = 0, patches = 0; // sums
    };
    std::vector<Part> partsOf(std::span<const uint32_t> wanted, std::span<const uint32_t> samplePasses) const;

    WorkerPool& pool_;
    std::vector<double> ofOne_;   // per chunk: the variance that one sample pass leaves, of a patch
    std::vector<double> patches_; // per chunk
};

} // namespace relume
