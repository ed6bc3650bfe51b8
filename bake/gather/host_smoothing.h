#pragma once

#include <cstdint>
#include <span>

#include "assets/base/worker_pool.h"
#include "bake/base/shader_types.h"

namespace relume {

/// Smooths sums over links, each replicate by itself, on devices whose memory is the CPU's own:
/// shaders/gather/smooth.comp and its other half in resolve.comp in loops of C++ that take eight texels at a
/// time. All pointers are to what the passes have in their buffers (link_passes.h), one entry per patch,
/// padding included, unless said otherwise. The same bytes come out whatever the number of threads.
struct HostSmoothing {
    const shader::Patch* patches = nullptr;
    const uint32_t* patchChart = nullptr;
    const uint32_t* texelToPatch = nullptr; // [size][size]
    const glm::vec2* distances =
        nullptr; // [m], along rows and columns; not needed where nothing is smoothed, as rows
    const glm::vec4* sums = nullptr;   // over links, [kReplicates][patches]
    glm::vec4* rows = nullptr;         // as sums, written: the smoothed ones
    const glm::vec2* scales = nullptr; // per chunk: x multiplies its sums; nullptr: nothing does
    uint32_t size = 0;                 // lightmap edge [texels]
    uint32_t chunkCount = 0;
    uint32_t reach = 0; // [texels], 0: nothing is smoothed
    float sigma = 0;    // [texels]
    // Which chunks are smoothed along rows, and which along columns, too; one mark per chunk, empty: all.
    std::span<const uint8_t> rowChunks = {}, chunks = {};
};
void smoothOnHost(WorkerPool& pool, const HostSmoothing& work);

} // namespace relume
