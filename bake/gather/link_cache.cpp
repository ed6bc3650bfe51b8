#include "bake/gather/link_cache.h"

#include "assets/base/error.h"
#include "bake/base/shader_types.h"

#include <algorithm>
#include <numeric>

namespace relume {
namespace {

using shader::kChunk;

// Returns how many chunks will be asked for.
uint32_t askedChunks(const LinkCache::Desc& desc) {
    if (desc.chunks.empty()) return desc.chunkCount;
    return std::accumulate(desc.chunks.begin(), desc.chunks.end(), 0u,
                           [](uint32_t sum, const ChunkRange& run) { return sum + run.count; });
}

} // namespace

LinkCache::LinkCache(const vk::Device& device, const Desc& desc)
    : device_(device), desc_(desc), chunkBytes_(uint64_t{desc.links} * kChunk * sizeof(uint32_t)),
      asked_(askedChunks(desc)),
      samplePassChunks_(desc.oneSamplePass
                            ? static_cast<uint32_t>(std::min<uint64_t>(asked_, desc.bytes / chunkBytes_))
                            : asked_),
      deviceChunks_(
          static_cast<uint32_t>(std::min<uint64_t>(samplePassChunks_, desc.deviceBytes / chunkBytes_))) {
    if (!desc.oneSamplePass) return;
    if (deviceChunks_ > 0) keep(deviceChunks_, vk::Memory::Device);
    if (samplePassChunks_ > deviceChunks_) keep(samplePassChunks_ - deviceChunks_, vk::Memory::Host);
}

uint64_t LinkCache::mostBytes(const Desc& desc) {
    const uint64_t chunkBytes = uint64_t{desc.links} * kChunk * sizeof(uint32_t);
    const uint64_t batch = std::min(desc.batch, desc.chunkCount) * chunkBytes;
    if (!desc.oneSamplePass) return batch;
    const uint64_t kept = std::min<uint64_t>(desc.chunkCount, desc.bytes / chunkBytes);
    return kept * chunkBytes + (kept < desc.chunkCount ? batch : 0);
}

// Takes the memory for the links of a sample pass, where they come next and there is room.
void LinkCache::keepIfRoom(uint32_t samplePass) {
    if (desc_.oneSamplePass || samplePass != kept_.size() || samplePassChunks_ == 0) return;
    const uint64_t bytes = (uint64_t{samplePass} + 1) * samplePassChunks_ * chunkBytes_;
    if (bytes <= desc_.bytes)
        keep(samplePassChunks_, bytes <= desc_.deviceBytes ? vk::Memory::Device : vk::Memory::Host);
}

void LinkCache::keep(uint32_t chunks, vk::Memory memory) {
    const vk::MemoryOwner owner(kOwner);
    kept_.push_back({vk::Buffer(device_, {.size = chunks * chunkBytes_, .memory = memory, .name = "links"}),
                     std::vector<uint8_t>(chunks, 0)});
}

// Returns the number of a chunk among those that will be asked for.
uint32_t LinkCache::numberOf(uint32_t chunk) const {
    if (desc_.chunks.empty()) return chunk;
    uint32_t before = 0;
    for (const ChunkRange& run : desc_.chunks) {
        if (chunk < run.first + run.count) return before + chunk - run.first;
        before += run.count;
    }
    return before;
}

// Returns nothing where a chunk's links are not kept.
std::optional<LinkCache::Slot> LinkCache::slotOf(uint32_t samplePass, uint32_t chunk) const {
    Slot slot{.kept = samplePass, .at = numberOf(chunk)};
    if (desc_.oneSamplePass) {
        const bool beyond = deviceChunks_ > 0 && slot.at >= deviceChunks_;
        slot.kept = beyond ? 1 : 0;
        if (beyond) slot.at -= deviceChunks_;
    }
    if (slot.kept >= kept_.size() || slot.at >= kept_[slot.kept].known.size()) return std::nullopt;
    return slot;
}

LinkCache::Place LinkCache::inStaging(uint32_t most, uint32_t before) {
    if (!staging_)
        staging_ = vk::Buffer(device_, {.size = desc_.batch * chunkBytes_, .name = "links of a batch"});
    return {&staging_, uint64_t{before} * desc_.links * kChunk, false,
            std::min(most, desc_.batch - std::min(before, desc_.batch))};
}

LinkCache::Place LinkCache::find(uint32_t samplePass, uint32_t first, uint32_t most, uint32_t before) {
    keepIfRoom(samplePass);
    const std::optional<Slot> slot = slotOf(samplePass, first);
    if (!slot) return inStaging(most, before);
    const SamplePass& kept = kept_[slot->kept];
    const auto from = kept.known.begin() + slot->at;
    const auto end = from + std::min(most, static_cast<uint32_t>(kept.known.end() - from));
    const bool known = *from != 0;
    const auto count = static_cast<uint32_t>(std::find(from, end, known ? 0 : 1) - from);
    return {&kept.links, uint64_t{slot->at} * desc_.links * kChunk, known, count};
}

LinkCache::Place LinkCache::passing(uint32_t samplePasses, uint32_t most) {
    forget();
    // Links that are read once go through the device's memory.
    const bool keeps = desc_.oneSamplePass && deviceChunks_ >= desc_.batch;
    const vk::Buffer* links = keeps ? &kept_.front().links : inStaging(most, 0).links;
    const auto room = static_cast<uint32_t>(links->size() / (samplePasses * chunkBytes_));
    ASSERT(room > 0);
    return {links, 0, false, std::min({most, room, desc_.batch})};
}

void LinkCache::note(uint32_t samplePass, ChunkRange range) {
    while (range.count > 0) {
        const std::optional<Slot> slot = slotOf(samplePass, range.first);
        if (!slot) return;
        std::vector<uint8_t>& known = kept_[slot->kept].known;
        const uint32_t count = std::min(range.count, static_cast<uint32_t>(known.size()) - slot->at);
        std::fill_n(known.begin() + slot->at, count, uint8_t{1});
        range = {range.first + count, range.count - count};
    }
}

void LinkCache::forget() {
    for (SamplePass& samplePass : kept_)
        std::fill(samplePass.known.begin(), samplePass.known.end(), uint8_t{0});
}

std::deque<LinkCache::SamplePass> LinkCache::release() {
    const auto isEmpty = [](const SamplePass& samplePass) {
        return std::find(samplePass.known.begin(), samplePass.known.end(), 1) == samplePass.known.end();
    };
    while (!kept_.empty() && isEmpty(kept_.back()))
        kept_.pop_back();
    return std::exchange(kept_, {});
}

void LinkCache::takeOver(std::deque<SamplePass> samplePasses) {
    ASSERT(!desc_.oneSamplePass && kept_.empty());
    const uint64_t each = samplePassChunks_ * chunkBytes_;
    while (!samplePasses.empty() && samplePasses.size() * each > desc_.bytes)
        samplePasses.pop_back();
    for (const SamplePass& samplePass : samplePasses)
        ASSERT(samplePass.links.size() == each && samplePass.known.size() == samplePassChunks_);
    kept_ = std::move(samplePasses);
}

uint64_t LinkCache::bytes() const {
    return std::accumulate(kept_.begin(), kept_.end(), uint64_t{0},
                           [](uint64_t sum, const SamplePass& kept) { return sum + kept.links.size(); });
}

} // namespace relume
