#include "bake/gather/chunk_senders.h"

#include "assets/base/portions.h"

#include <algorithm>
#include <numeric>

namespace relume {

ChunkSenders::ChunkSenders(WorkerPool& pool, std::span<const shader::Patch> patches)
    : senders_(patches.size() / shader::kChunk, 0), full_(senders_.size(), 0) {
    constexpr size_t kPortion = 512; // chunks
    runPortions(pool, senders_.size(), kPortion, [&](size_t begin, size_t end) {
        for (size_t chunk = begin; chunk < end; ++chunk)
            count(patches, static_cast<uint32_t>(chunk));
    });
}

void ChunkSenders::update(std::span<const shader::Patch> patches, const std::vector<glm::uvec2>& changed) {
    for (uint32_t chunk = 0; chunk < senders_.size(); ++chunk)
        if ((changed[chunk].x | changed[chunk].y) != 0) count(patches, chunk);
}

void ChunkSenders::count(std::span<const shader::Patch> patches, uint32_t chunk) {
    const auto own = patches.subspan(size_t{chunk} * shader::kChunk, shader::kChunk);
    senders_[chunk] = static_cast<uint32_t>(std::count_if(
        own.begin(), own.end(), [](const shader::Patch& p) { return (p.flags & shader::kPatchSends) != 0; }));
    full_[chunk] = std::all_of(own.begin(), own.end(),
                               [](const shader::Patch& p) { return shader::patchIsShown(p.flags); });
}

uint64_t ChunkSenders::count(ChunkRange range) const {
    const auto first = senders_.begin() + range.first;
    return std::accumulate(first, first + range.count, uint64_t{0});
}

} // namespace relume
