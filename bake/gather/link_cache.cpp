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
      roundChunks_(desc.oneRound ? static_cast<uint32_t>(std::min<uint64_t>(asked_, desc.bytes / chunkBytes_))
                                 : asked_) {
    if (desc.oneRound) keepIfRoom(0);
}

uint64_t LinkCache::mostBytes(const Desc& desc) {
    const uint64_t chunkBytes = uint64_t{desc.links} * kChunk * sizeof(uint32_t);
    const uint64_t batch = std::min(desc.batch, desc.chunkCount) * chunkBytes;
    if (!desc.oneRound) return batch;
    const uint64_t kept = std::min<uint64_t>(desc.chunkCount, desc.bytes / chunkBytes);
    return kept * chunkBytes + (kept < desc.chunkCount ? batch : 0);
}

// Takes the memory for the links of a sample pass, where they come next and there is room.
void LinkCache::keepIfRoom(uint32_t round) {
    if (round != kept_.size() || roundChunks_ == 0) return;
    const uint64_t bytes = roundChunks_ * chunkBytes_;
    if ((uint64_t{round} + 1) * bytes > desc_.bytes) return;
    const vk::MemoryOwner owner(kOwner);
    kept_.push_back(
        {vk::Buffer(device_, {.size = bytes, .name = "links"}), std::vector<uint8_t>(roundChunks_, 0)});
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

LinkCache::Place LinkCache::find(uint32_t round, uint32_t first, uint32_t most) {
    const uint32_t slot = desc_.oneRound ? 0 : round;
    keepIfRoom(slot);
    const uint32_t at = slotOf(first);
    if (slot >= kept_.size() || at >= roundChunks_) {
        if (!staging_)
            staging_ = vk::Buffer(device_, {.size = desc_.batch * chunkBytes_, .name = "links of a batch"});
        return {&staging_, 0, false, std::min(most, desc_.batch)};
    }
    const Round& kept = kept_[slot];
    const auto from = kept.known.begin() + at;
    const auto end = from + std::min(most, roundChunks_ - at);
    const bool known = *from != 0;
    const auto count = static_cast<uint32_t>(std::find(from, end, known ? 0 : 1) - from);
    return {&kept.links, uint64_t{at} * desc_.links * kChunk, known, count};
}

LinkCache::Place LinkCache::passing(uint32_t rounds, uint32_t most) {
    forget();
    const vk::Buffer* links = desc_.oneRound && !kept_.empty() ? &kept_.front().links : nullptr;
    if (!links || links->size() < desc_.batch * chunkBytes_) {
        if (!staging_)
            staging_ = vk::Buffer(device_, {.size = desc_.batch * chunkBytes_, .name = "links of a batch"});
        links = &staging_;
    }
    const auto room = static_cast<uint32_t>(links->size() / (rounds * chunkBytes_));
    ASSERT(room > 0);
    return {links, 0, false, std::min({most, room, desc_.batch})};
}

void LinkCache::note(uint32_t round, ChunkRange range) {
    const uint32_t slot = desc_.oneRound ? 0 : round;
    const uint32_t at = slotOf(range.first);
    if (slot >= kept_.size() || at >= roundChunks_) return;
    const uint32_t count = std::min(range.count, roundChunks_ - at);
    std::fill_n(kept_[slot].known.begin() + at, count, uint8_t{1});
}

void LinkCache::forget() {
    for (Round& round : kept_)
        std::fill(round.known.begin(), round.known.end(), uint8_t{0});
}

void LinkCache::takeOver(std::deque<Round> rounds) {
    ASSERT(!desc_.oneRound && kept_.empty());
    const uint64_t each = roundChunks_ * chunkBytes_;
    while (!rounds.empty() && rounds.size() * each > desc_.bytes)
        rounds.pop_back();
    for (const Round& round : rounds)
        ASSERT(round.links.size() == each && round.known.size() == roundChunks_);
    kept_ = std::move(rounds);
}

uint64_t LinkCache::bytes() const {
    return kept_.size() * roundChunks_ * chunkBytes_;
}

} // namespace relume
