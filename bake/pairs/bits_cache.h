#pragma once

#include <unordered_map>
#include <vector>

#include "bake/base/shader_types.h"
#include "bake/vk/buffer.h"

namespace relume {

/// A set of units of a super-block, one bit each.
struct UnitMask {
    glm::uvec4 lo{0u}, hi{0u}; // bit u % 32 of word u / 32

    void set(uint32_t unit) { word(unit) |= 1u << unit % 32; }
    bool has(uint32_t unit) const { return (word(unit) >> unit % 32 & 1u) != 0; }
    UnitMask without(const UnitMask& other) const { return {lo & ~other.lo, hi & ~other.hi}; }
    UnitMask with(const UnitMask& other) const { return {lo | other.lo, hi | other.hi}; }
    UnitMask within(const UnitMask& other) const { return {lo & other.lo, hi & other.hi}; }
    uint32_t count() const; // of units in it
    /// Returns the set of units first .. last - 1.
    static UnitMask range(uint32_t first, uint32_t last);

private:
    uint32_t& word(uint32_t unit) { return unit < 128 ? lo[int(unit / 32)] : hi[int(unit / 32 - 4)]; }
    uint32_t word(uint32_t unit) const { return unit < 128 ? lo[int(unit / 32)] : hi[int(unit / 32 - 4)]; }
};

/// The visibility cache keeps bits of super-blocks for later passes, in memory taken piece by piece, up to a
/// limit. Super-blocks that come when it is full are not kept.
class BitsCache {
public:
    struct Entry {
        VkDeviceAddress address = 0;
        uint32_t* host = nullptr; // where the host can see it
        UnitMask known;
    };
    struct Desc {
        uint64_t slotBytes = 0; // of one super-block
        uint64_t slots = 0;     // most super-blocks that may come; 0: no cache
        uint64_t maxBytes = 0;
    };
    BitsCache(const vk::Device& device, const Desc& desc);
    /// The ledger counts kept bits as those of this owner (vk::MemoryOwner).
    static constexpr const char* kOwner = "bits cache";

    /// Returns the super-block's entry; null when it is not kept and no room is left. Pointers stay valid.
    Entry* find(uint32_t row, uint32_t column);
    /// Returns the super-block's entry where it is kept already, else nullptr.
    const Entry* peek(uint32_t row, uint32_t column) const;
    uint64_t bytes() const { return bytes_; } // taken so far
    bool full() const { return next_ >= slots_; }
    /// Forgets the units of columns (chunks) whose senders have changed. Returns the share of units that is
    /// left.
    double forgetColumns(const std::vector<bool>& changed);

private:
    bool grow();

    const vk::Device& device_;
    Desc desc_;
    uint64_t slots_ = 0; // that fit
    uint64_t next_ = 0;  // slot to be given out
    uint64_t bytes_ = 0;
    std::vector<vk::Buffer> blocks_;
    uint64_t slotsOfBlock_ = 0;
    std::unordered_map<uint64_t, Entry> entries_; // by row << 32 | column
};

} // namespace relume
