#pragma once

#include <span>

#include "assets/base/worker_pool.h"
#include "bake/direct/host_points.h"

namespace relume {

/// Sampling analytic lights and gathering their light on the CPU: shaders/direct/lamp_samples.comp and
/// lamp_gather.comp in loops of C++, for all of them but the sky. The same bytes come out whatever the number
/// of threads.
struct HostLamps {
    HostPoints points;
    std::span<const shader::Lamp> lamps; // of one group, with the samples of one sample pass
    float reach = 0;                     // out of the scene [m]
};
void sampleLamps(WorkerPool& pool, const HostLamps& work);
void gatherLamps(WorkerPool& pool, const HostLamps& work);

} // namespace relume
