#pragma once

#include <span>

#include "assets/base/worker_pool.h"
#include "bake/direct/host_points.h"

namespace relume {

/// Sampling mesh lights and gathering their light on the CPU: shaders/direct/emitter_samples.comp and
/// direct.comp in loops of C++, where all polygons are sampled. The same bytes come out whatever the number
/// of threads.
struct HostEmitters {
    HostPoints points;
    std::span<const shader::EmitterPolygon> polygons; // of one group, few of them
    glm::vec4* picks = nullptr; // [chunk - firstChunk][polygons.size()][64], as in EmitterSamplesPush
    glm::vec4* near = nullptr;  // likewise: of what is near, as in EmitterSamplesPush
    uint32_t pointCount = 0;    // on each polygon and sample pass, a multiple of kReplicates

    /// Returns the points on each polygon of all sample passes that are taken together.
    uint32_t allPoints() const { return pointCount * points.together; }
};
void sampleEmitters(WorkerPool& pool, const HostEmitters& work);
void gatherEmitters(WorkerPool& pool, const HostEmitters& work);

} // namespace relume
