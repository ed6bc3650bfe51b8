#pragma once

#include <cstdint>
#include <vector>

#include "bake/gather/host_smoothing.h"

namespace relume {

/// Makes a layer's result of its sums over links, on devices whose memory is the CPU's own:
/// shaders/gather/resolve.comp and layer_result.comp in loops of C++. What HostSmoothing says holds here,
/// too.
struct LayerResolve {
    HostSmoothing smoothing;           // of all chunks, without scales
    const glm::vec4* direct = nullptr; // lighting, and the variance of R, G and B together
    glm::vec4* result = nullptr;       // written: lighting and its standard error
    float scale = 1;                   // from a replicate's sum to its mean; 0: there is no indirect light
};

/// Sums per chunk: of indirect light, and of the result as in LayerResultPush.
struct LayerResolveSums {
    std::vector<shader::ResolveSums> indirect;
    std::vector<glm::vec4> result;
};
LayerResolveSums resolveLayer(WorkerPool& pool, const LayerResolve& work);

/// Makes a link solver's result likewise, as shaders/gather/resolve.comp alone.
struct LinkResolve {
    HostSmoothing smoothing;               // its chunks are those that are resolved
    const glm::vec4* directSums = nullptr; // [kReplicates][patches]; nullptr: there is no direct light
    glm::vec4* result = nullptr;           // written: lighting and its standard error
    // From a replicate's sums over links, and of direct light, to their means; not used where chunks have
    // scales of their own (x, y).
    float scale = 0, directScale = 0;
    float floor = 0;                     // as of SmoothPush
    shader::ResolveSums* sums = nullptr; // written, per chunk
    shader::LocalSums* local = nullptr;  // written, per chunk
    uint32_t* lightBins = nullptr;       // written: [kLightBins], as lib/local_error.glsl says
    uint32_t* errorBins = nullptr;       // written: [kErrorBins]
};
void resolveLinks(WorkerPool& pool, const LinkResolve& work);

} // namespace relume
