#pragma once

#include "app/offline/probe_options.h"
#include "app/offline/probe_set.h"

namespace relume {

/// Traces and gathers the probes of a finished bake, light by light where it has layers. Throws Error, and
/// what this thread's watch throws.
ProbeSet bakeProbes(const vk::Device& device, const Scene& scene, Baker& baker, const ProbePlan& plan,
                    uint32_t samples, float reflectivity);

} // namespace relume
