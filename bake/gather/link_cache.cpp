#include "bake/gather/link_cache.h"

#include "bake/base/shader_types.h"

#include <algorithm>

namespace relume {
namespace {

using shader::kChunk;

} // namespace

LinkCache::LinkCache(const vk::Device& device, const Desc& desc)
    : device_(device), desc_(desc),
      roundBytes_(uint64_t{desc.chunkCount} * desc.links * kChunk * sizeof(uint32_t)) {}

LinkCache::Place LinkCache::find(uint32_t round, uint32_t first, uint32_t most) {
    const uint64_t perChunk = uint64_t{desc_.links} * kChunk;
    if (round == kept_.size() && (round + 1) * roundBytes_ <= desc_.bytes)
        kept_.push_back({vk::Buffer(device_, {.size = roundBytes_, .name = "links"}),
                         std::vector<uint8_t>(desc_.chunkCount, 0)});
    if (round >= kept_.size()) {
        if (!staging_)
            staging_ = vk::Buffer(
                device_, {.size = desc_.batch * perChunk * sizeof(uint32_t), .name = "links of a batch"});
        return {&staging_, 0, false, std::min(most, desc_.batch)};
    }
    const Round& kept = kept_[round];
    const auto from = kept.known.begin() + first;
    const auto end = from + std::min(most, desc_.chunkCount - first);
    const bool known = *from != 0;
    const auto count = static_cast<uint32_t>(std::find(from, end, known ? 0 : 1) - from);
    return {&kept.links, first * perChunk, known, count};
}

void LinkCache::note(uint32_t round, ChunkRange range) {
    if (round < kept_.size()) std::fill_n(kept_[round].known.begin() + range.first, range.count, uint8_t{1});
}

} // namespace relume
