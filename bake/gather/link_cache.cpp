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
                            : asked_) {
    if (desc.oneSamplePass) keepIfRoom(0);
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
    if (samplePass != kept_.size() || samplePassChunks_ == 0) return;
    const uint64_t bytes = samplePassChunks_ * chunkBytes_;
    if ((uint64_t{samplePass} + 1) * bytes > desc_.bytes) return;
    const vk::MemoryOwner owner(kOwner);
    kept_.push_back(
        {vk::Buffer(device_, {.size = bytes, .name = "links"}), std::vector<uint8_t>(samplePassChunks_, 0)});
}

// Returns the place of a chunk among those that will be asked for.
uint32_t LinkCache::slotOf(uint32_t chunk) const {
    if (desc_.chunks.empty()) return chunk;
    uint32_t before = 0;
    for (const ChunkRange& run : desc_.chunks) {
        if (chunk < run.first + run.count) return before + chunk - run.first;
        before += run.count;
    }
    return before;
}

LinkCache::Place LinkCache::find(uint32_t samplePass, uint32_t first, uint32_t most) {
    const uint32_t slot = desc_.oneSamplePass ? 0 : samplePass;
    keepIfRoom(slot);
    const uint32_t at = slotOf(first);
    if (slot >= kept_.size() || at >= samplePassChunks_) {
        if (!staging_)
            staging_ = vk::Buffer(device_, {.size = desc_.batch * chunkBytes_, .name = "links of a batch"});
        return {&staging_, 0, false, std::min(most, desc_.batch)};
    }
    const SamplePass& kept = kept_[slot];
    const auto from = kept.known.begin() + at;
    const auto end = from + std::min(most, samplePassChunks_ - at);
    const bool known = *from != 0;
    const auto count = static_cast<uint32_t>(std::find(from, end, known ? 0 : 1) - from);
    return {&kept.links, uint64_t{at} * desc_.links * kChunk, known, count};
}

LinkCache::Place LinkCache::passing(uint32_t samplePasses, uint32_t most) {
    forget();
    const vk::Buffer* links = desc_.oneSamplePass && !kept_.empty() ? &kept_.front().links : nullptr;
    if (!links || links->size() < desc_.batch * chunkBytes_) {
        if (!staging_)
            staging_ = vk::Buffer(device_, {.size = desc_.batch * chunkBytes_, .name = "links of a batch"});
        links = &staging_;
    }
    const auto room = static_cast<uint32_t>(links->size() / (samplePasses * chunkBytes_));
    ASSERT(room > 0);
    return {links, 0, false, std::min({most, room, desc_.batch})};
}

void LinkCache::note(uint32_t samplePass, ChunkRange range) {
    const uint32_t slot = desc_.oneSamplePass ? 0 : samplePass;
    const uint32_t at = slotOf(range.first);
    if (slot >= kept_.size() || at >= samplePassChunks_) return;
    const uint32_t count = std::min(range.count, samplePassChunks_ - at);
    std::fill_n(kept_[slot].known.begin() + at, count, uint8_t{1});
}

void LinkCache::forget() {
    for (SamplePass& samplePass : kept_)
        std::fill(samplePass.known.begin(), samplePass.known.end(), uint8_t{0});
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
    return kept_.size() * samplePassChunks_ * chunkBytes_;
}

} // namespace relume
