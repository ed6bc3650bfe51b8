#include "bake/pairs/bits_cache.h"

#include "assets/base/error.h"
#include "assets/base/log.h"

#include <algorithm>
#include <bit>

namespace relume {
namespace {

using shader::kSuper;
using shader::kSuperBlocks;

// Allocations are few, and none is so large that a fragmented heap refuses it.
constexpr uint64_t kBlockBytes = uint64_t{256} << 20;

uint64_t keyOf(uint32_t row, uint32_t column) {
    return uint64_t{row} << 32 | column;
}

} // namespace

uint32_t UnitMask::count() const {
    int count = 0;
    for (int i = 0; i < 4; ++i)
        count += std::popcount(lo[i]) + std::popcount(hi[i]);
    return static_cast<uint32_t>(count);
}

UnitMask UnitMask::range(uint32_t first, uint32_t last) {
    UnitMask mask;
    for (uint32_t unit = first; unit < last; ++unit)
        mask.set(unit);
    return mask;
}

BitsCache::BitsCache(const vk::Device& device, const Desc& desc)
    : device_(device), desc_(desc), slotsOfBlock_(std::max<uint64_t>(1, kBlockBytes / desc.slotBytes)) {
    slots_ = std::min(desc.slots, desc.maxBytes / desc.slotBytes);
}

// Takes the next piece of memory: what is still wanted, at most kBlockBytes.
bool BitsCache::grow() {
    const uint64_t slots = std::min(slotsOfBlock_, slots_ - next_);
    const vk::MemoryOwner owner(kOwner);
    try {
        blocks_.emplace_back(device_,
                             vk::Buffer::Desc{.size = slots * desc_.slotBytes, .name = "visibility cache"});
    } catch (const Error& error) {
        spdlog::warn("visibility cache: {}; it stays at {} MiB, the rest is traced in every pass",
                     error.what(), bytes_ >> 20);
        slots_ = next_;
        return false;
    }
    bytes_ += blocks_.back().size();
    return true;
}

const BitsCache::Entry* BitsCache::peek(uint32_t row, uint32_t column) const {
    const auto found = entries_.find(keyOf(row, column));
    return found != entries_.end() ? &found->second : nullptr;
}

BitsCache::Entry* BitsCache::find(uint32_t row, uint32_t column) {
    const uint64_t key = keyOf(row, column);
    const auto found = entries_.find(key);
    if (found != entries_.end()) return &found->second;
    if (next_ >= slots_) return nullptr;
    const uint64_t inBlock = next_ % slotsOfBlock_;
    if (inBlock == 0 && !grow()) return nullptr;
    const vk::Buffer& block = blocks_.back();
    const uint64_t offset = inBlock * desc_.slotBytes;
    Entry entry{.address = block.address() + offset, .known = {}};
    if (block.mapped()) entry.host = static_cast<uint32_t*>(block.mapped()) + offset / sizeof(uint32_t);
    ++next_;
    return &entries_.emplace(key, entry).first->second;
}

double BitsCache::forgetColumns(const std::vector<bool>& changed) {
    uint64_t before = 0, after = 0;
    for (auto& [key, entry] : entries_) {
        UnitMask gone;
        const size_t first = (key & 0xffffffffu) * kSuper;
        for (uint32_t c = 0; c < kSuper; ++c) {
            const bool keep = first + c < changed.size() && !changed[first + c];
            for (uint32_t unit = c; !keep && unit < kSuperBlocks; unit += kSuper)
                gone.set(unit);
        }
        before += entry.known.count();
        entry.known = entry.known.without(gone);
        after += entry.known.count();
    }
    return before > 0 ? static_cast<double>(after) / static_cast<double>(before) : 1.0;
}

} // namespace relume
