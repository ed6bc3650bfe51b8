#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace relume {

/// Sums over the patches of a chunk that are shown, after the sample passes that it has. Variances are of the
/// mean, R, G and B together; local ones are relative to the square of what local error is relative to.
struct ChunkVariance {
    double patches = 0;
    double direct = 0, indirect = 0;           // [(cd/m^2)^2]
    double localDirect = 0, localIndirect = 0; // [1]
};

/// Holds what a plan goes by.
struct ChunkPlanRules {
    double localError = 0; // standard deviation that a chunk's patches may have in the mean, relative; 0: any
    double variance = 0;   // that may be left over all patches [(cd/m^2)^2]; 0: any
    double directCost = 1, linkCost = 1; // of a sample pass of each kind, in one unit
    uint32_t mostSamplePasses = 1;       // of each kind, of a chunk
    bool hasDirect = false;
};

/// The sample passes that each chunk is to have.
struct ChunkPlan {
    std::vector<uint32_t> direct, links;
    bool operator==(const ChunkPlan&) const = default;
};

/// Returns the sample passes by which each chunk comes to the local error and all of them together to the
/// variance, for the least cost as far as the variances of `now` tell. A chunk whose local error is reached
/// gets more only where the sum over all asks for it, and then in proportion to the root of variance over
/// cost [Neyman 1934]. A chunk is taken for no better than its neighbours in the order of chunks: a few
/// samples may all have missed what is rare. No chunk gets more than kMostChunkGrowth times what it has.
ChunkPlan planChunks(const ChunkPlanRules& rules, std::span<const ChunkVariance> chunks,
                     const ChunkPlan& now);

constexpr uint32_t kMostChunkGrowth = 4;

/// Returns the variance of a patch of this chunk that one sample pass leaves, no smaller than in the mean
/// over its neighbours in the order of chunks; 0 where no patch is shown. `which` is the variance that is
/// left after so many sample passes.
double pooledVariance(std::span<const ChunkVariance> chunks, std::span<const uint32_t> samplePasses,
                      double ChunkVariance::*which, size_t chunk);

} // namespace relume
