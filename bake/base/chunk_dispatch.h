#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "bake/base/chunk_order.h"
#include "bake/vk/program.h"

namespace relume {

/// Dispatches one workgroup per chunk, or per item of any list, for kernels that count workgroups in y, too.
template<typename Push>
void dispatchChunks(const vk::ComputeProgram& program, VkCommandBuffer cmd, const Push& push,
                    uint32_t chunks) {
    constexpr uint32_t kMaxX = 32768; // workgroups in x, below every device's limit
    const uint32_t x = std::min(chunks, kMaxX);
    program.dispatch(cmd, push, x, (chunks + x - 1) / x);
}

/// The chunks that a pass works on, in runs; nothing: all.
using SomeChunks = std::optional<std::span<const ChunkRange>>;

/// Calls `work` for each run of these chunks, of `all` where none are named.
template<typename Work>
void forRuns(const SomeChunks& chunks, uint32_t all, const Work& work) {
    if (!chunks) return work(ChunkRange{0, all});
    for (const ChunkRange& run : *chunks)
        work(run);
}

} // namespace relume
