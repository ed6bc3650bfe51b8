#pragma once

#include <span>

#include "bake/base/shader_types.h"
#include "assets/base/worker_pool.h"

namespace relume {

/// Sampling analytic lights and gathering their light for devices whose memory is the CPU's own:
/// shaders/direct/lamp_samples.comp and lamp_gather.comp in loops of C++, for all of them but the sky.
/// Pointers are to what LampLight has in its buffers; per patch: padding included. The same bytes come out
/// whatever the number of threads.
struct HostLamps {
    const shader::Patch* patches = nullptr;
    const shader::PatchCover* covers =
        nullptr;                         // of all patches, where samples start; nullptr: at their points
    std::span<const shader::Lamp> lamps; // of one group
    glm::vec4* targets = nullptr;        // [chunk - firstChunk][targetCount][64], as in LampPush
    const uint32_t* bits = nullptr;      // which of them are seen, as in SegmentPush
    const uint32_t* parts = nullptr;     // per patch
    glm::uvec2* penumbra =
        nullptr;                 // per part, shaders/lib/light/penumbra.glsl; nullptr: all patches take part
    glm::vec4* sums = nullptr;   // [kReplicates][patchCount], added to
    bool newSums = false;        // nothing is in the sums yet
    glm::vec4* direct = nullptr; // per patch: the mean so far
    uint32_t firstChunk = 0, chunkCount = 0;
    uint32_t targetCount = 0; // of the group, per patch
    uint32_t samplePass = 0;
    uint32_t patchCount = 0;
    float reach = 0; // out of the scene [m]
    float scale = 1; // from the sum of all sums to the mean
};
void sampleLamps(WorkerPool& pool, const HostLamps& work);
void gatherLamps(WorkerPool& pool, const HostLamps& work);

} // namespace relume
