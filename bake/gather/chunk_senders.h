#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/base/worker_pool.h"
#include "bake/base/chunk_order.h"
#include "bake/base/shader_types.h"

namespace relume {

/// Counts the patches of each chunk that send light.
class ChunkSenders {
public:
    /// Takes patches of whole chunks. All threads count.
    ChunkSenders(WorkerPool& pool, std::span<const shader::Patch> patches);
    /// Counts anew in chunks of which a patch has changed: one entry per chunk, a bit for each patch.
    void update(std::span<const shader::Patch> patches, const std::vector<glm::uvec2>& changed);
    uint64_t count(ChunkRange range) const;
    uint32_t chunks() const { return static_cast<uint32_t>(senders_.size()); }
    /// Returns per chunk whether all of its patches are shown: not 0.
    const std::vector<uint8_t>& full() const { return full_; }

private:
    void count(std::span<const shader::Patch> patches, uint32_t chunk);

    std::vector<uint32_t> senders_; // per chunk
    std::vector<uint8_t> full_;
};

} // namespace relume
