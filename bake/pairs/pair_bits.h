#pragma once

#include <memory>
#include <optional>

#include "bake/pairs/bits_cache.h"
#include "bake/pairs/pair_batch.h"
#include "bake/pairs/pair_passes.h"

namespace relume {

/// Knows where the bits of super-blocks are: in the visibility cache as long as it has room, in a small ring
/// otherwise.
class PairBits {
public:
    struct Desc {
        uint64_t slotBytes = 0;             // of a super-block
        uint64_t supers = 0;                // of a pass, at most
        uint32_t batch = 0;                 // super-blocks of a batch, at most: the ring has room for these
        std::optional<uint64_t> cacheBytes; // at most; nothing: no cache is wanted
    };
    PairBits(const vk::Device& device, const Desc& desc);

    void beginPass() { turn_ = 0; }
    /// Returns the units of a super-block whose bits are kept.
    UnitMask known(uint32_t row, uint32_t column) const;
    /// The places of a batch's super-blocks, one entry for each.
    struct Places {
        std::vector<SuperBlock> supers;
        std::vector<uint32_t*> bits;            // where the host can see them
        std::vector<BitsCache::Entry*> entries; // nullptr: not kept
    };
    /// Finds places for a batch; takes memory where that is needed.
    Places place(const PairBatch& batch);
    /// Takes note of what the batch has traced.
    static void note(const PairBatch& batch, const Places& places);
    /// Forgets columns whose senders have changed.
    void forgetColumns(const std::vector<bool>& changed);

    /// Counts the rays that bits in the cache took.
    void addRays(uint64_t rays) { rays_ += static_cast<double>(rays); }
    uint64_t rays() const { return static_cast<uint64_t>(rays_); }
    uint64_t cacheBytes() const { return cache_ ? cache_->bytes() : 0; } // taken so far
    /// Returns the number of super-blocks of the pass that were not kept.
    uint64_t turn() const { return turn_; }
    void resume(uint64_t turn) { turn_ = turn; }

private:
    const vk::Device& device_;
    Desc desc_;
    std::unique_ptr<BitsCache> cache_;
    BitsRing ring_; // made when it is needed
    uint64_t turn_ = 0;
    double rays_ = 0;
};

} // namespace relume
