#pragma once

#include <span>
#include <vector>

#include "assets/base/worker_pool.h"
#include "bake/lights/light_source.h"
#include "bake/probes/probe_links.h"
#include "bake/probes/spherical_harmonics.h"

namespace relume {

/// What shines on probes: all that may change without a ray.
struct ProbeLight {
    std::vector<glm::vec4> radiance = {}; // per patch [cd/m^2], what it sends
    const Sky* sky = nullptr;             // its picture; nullptr: none
    glm::vec3 skyRadiance{0.0f};          // in place of the sky's own [cd/m^2]
    std::vector<glm::vec3> lamps = {};    // colour times intensity of each traced analytic light
};

/// Returns the light of these sources at their weights: `lighting` is what they bring to every patch by all
/// bounces [cd/m^2, irradiance / pi], to which the sources themselves are added, as probes see them. Patches,
/// scene and light belong together; the sky is the scene's, which must outlive the result.
ProbeLight probeLight(const Scene& scene, const PatchSet& patches, std::span<const LightSource> sources,
                      std::span<const glm::vec4> lighting, float reflectivity);

/// Sums light over links; no rays. Mesh lights shine by the links that meet them, the sky by those that meet
/// nothing, analytic lights by their own rays, so that nothing counts twice. Returns for each light the
/// harmonics of each probe [cd/m^2]; the same bytes on any number of threads. Tells this thread's watch that
/// this share of all probes is done; what it throws ends the sum.
std::vector<std::vector<Harmonics>> gatherProbes(WorkerPool& pool, const ProbeLinks& links,
                                                 std::span<const ProbeLight> lights, double done = -1.0);

/// Returns for each probe the share of the sphere on which it sees backs of surfaces.
std::vector<double> probeBacks(WorkerPool& pool, const ProbeLinks& links);

/// Returns how many lights may be gathered at a time, at least one: their radiance of so many patches is in
/// memory.
size_t probeLightsAtOnce(uint64_t patches);

/// A probe's result.
struct Probe {
    glm::vec3 position{0.0f};                   // [m]
    Harmonics radiance{};                       // [cd/m^2]
    double backs = 0;                           // share of the sphere on which it sees backs of surfaces
    bool inside() const { return backs > 0.5; } // behind or within walls: its light means nothing
};

} // namespace relume
