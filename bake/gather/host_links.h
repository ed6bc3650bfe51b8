#pragma once

#include <span>

#include "bake/base/shader_types.h"
#include "assets/base/worker_pool.h"

namespace relume {

/// This gathers links on devices whose memory is the CPU's own: it makes the sums of
/// shaders/gather/links.comp in loops of C++, which are several times as fast as the shader on such a device.
/// All pointers are to what the passes have in their buffers (link_passes.h), one entry per patch, padding
/// included, unless said otherwise. The same bytes come out whatever the number of threads.

/// Links of chunks firstChunk .. firstChunk + chunkCount - 1.
struct HostLinks {
    const uint32_t* links = nullptr;     // [chunk - firstChunk][samples][64]
    const glm::vec4* radiance = nullptr; // of what links may end at [cd/m^2]
    glm::vec3 sky{0.0f};                 // radiance of what kLinkSky ends at [cd/m^2]
    const glm::vec4* direct = nullptr;   // added to ligOut where there is one
    glm::vec4* ligOut = nullptr;         // direct + the mean over the samples; may be none
    glm::vec4* sums = nullptr;           // [kReplicates][patchCount], added to; may be none
    bool newSums = false;                // nothing is in these yet
    uint32_t firstChunk = 0, chunkCount = 0;
    uint32_t samples = 0; // a multiple of kReplicates
    uint32_t patchCount = 0;
};
void gatherLinks(WorkerPool& pool, const HostLinks& work);

/// The work after a bounce: it makes what patches send next, and tells how much the light changed.
struct HostSend {
    const shader::Patch* patches = nullptr;
    const glm::vec4* albedo = nullptr;
    const glm::vec4* before = nullptr; // light before the bounce
    const glm::vec4* light = nullptr;  // light that came of it
    glm::vec4* radiance = nullptr;     // written: reflectivity * albedo * light, of those that send
    glm::vec4* changes = nullptr;      // per chunk, as in ChangePush; nullptr: not told
    bool isFirst = false;              // of changes: it is the first bounce
    const uint8_t* full = nullptr;     // per chunk, not 0: all of its patches send and are shown
    float reflectivity = 1;
    uint32_t chunkCount = 0;
};
void sendLight(WorkerPool& pool, const HostSend& work);

} // namespace relume
