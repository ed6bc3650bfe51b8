#pragma once

#include <cstdint>
#include <vector>

#include "bake/base/shader_types.h"
#include "assets/base/worker_pool.h"

namespace relume {

/// Makes a layer's result of its sums over links, on devices whose memory is the CPU's own:
/// shaders/gather/smooth.comp, resolve.comp and layer_result.comp in loops of C++ that take eight texels at a
/// time. All pointers are to what the passes have in their buffers (link_passes.h, and those of layers), one
/// entry per patch, padding included, unless said otherwise. The same bytes come out whatever the number of
/// threads.
struct HostResolve {
    const shader::Patch* patches = nullptr;
    const uint32_t* patchChart = nullptr;
    const uint32_t* texelToPatch = nullptr; // [size][size]
    const float* distances = nullptr;       // [m]
    const glm::vec4* sums = nullptr;        // over links, [kReplicates][patches]
    glm::vec4* rows = nullptr;              // as sums, overwritten; not needed where nothing is smoothed
    const glm::vec4* direct = nullptr;      // lighting, and the variance of R, G and B together
    glm::vec4* result = nullptr;            // written: lighting and its standard error
    uint32_t size = 0;                      // lightmap edge [texels]
    uint32_t chunkCount = 0;
    uint32_t reach = 0; // of smoothing [texels], 0: none
    float sigma = 0;    // of smoothing [texels]
    float scale = 1;    // from a replicate's sum to its mean; 0: there is no indirect light
};

/// Sums per chunk: of indirect light, and of the result as in LayerResultPush.
struct HostResolveSums {
    std::vector<shader::ResolveSums> indirect;
    std::vector<glm::vec4> result;
};
HostResolveSums resolveLayer(WorkerPool& pool, const HostResolve& work);

} // namespace relume
