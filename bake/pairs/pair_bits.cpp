#include "bake/pairs/pair_bits.h"

#include "assets/base/log.h"

namespace relume {

PairBits::PairBits(const vk::Device& device, const Desc& desc) : device_(device), desc_(desc) {
    if (!desc.cacheBytes) return;
    if (*desc.cacheBytes < desc.slotBytes) {
        spdlog::warn(
            "visibility cache: {} bytes do not hold one super-block ({} KiB): everything is traced in "
            "every pass",
            *desc.cacheBytes, desc.slotBytes >> 10);
        return;
    }
    cache_ = std::make_unique<BitsCache>(
        device,
        BitsCache::Desc{.slotBytes = desc.slotBytes, .slots = desc.supers, .maxBytes = *desc.cacheBytes});
}

UnitMask PairBits::known(uint32_t row, uint32_t column) const {
    const BitsCache::Entry* entry = cache_ ? cache_->peek(row, column) : nullptr;
    return entry ? entry->known : UnitMask{};
}

PairBits::Places PairBits::place(const PairBatch& batch) {
    Places places;
    for (size_t s = 0; s < batch.supers.size(); ++s) {
        const PairBatch::Super& super = batch.supers[s];
        BitsCache::Entry* entry = cache_ ? cache_->find(super.row, super.column) : nullptr;
        if (!entry && !ring_.bits) ring_ = BitsRing(device_, desc_.batch, desc_.slotBytes);
        const uint64_t slot = turn_ % desc_.batch;
        places.supers.push_back({.row = super.row,
                                 .column = super.column,
                                 .bits = entry ? entry->address : ring_.address(slot),
                                 .known0 = super.known.lo,
                                 .known1 = super.known.hi,
                                 .counters = entry ? 0 : shader::kRayCounters});
        places.bits.push_back(entry ? entry->host : ring_.host(slot));
        places.entries.push_back(entry);
        if (!entry && s < batch.complete) ++turn_;
    }
    return places;
}

void PairBits::note(const PairBatch& batch, const Places& places) {
    for (size_t s = 0; s < batch.supers.size(); ++s)
        if (BitsCache::Entry* entry = places.entries[s])
            entry->known = entry->known.with(batch.supers[s].traced);
}

void PairBits::forgetColumns(const std::vector<bool>& changed) {
    if (cache_) rays_ *= cache_->forgetColumns(changed);
}

} // namespace relume
