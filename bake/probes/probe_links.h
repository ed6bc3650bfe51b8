#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/model/scene.h"
#include "bake/lights/lamps.h"
#include "bake/probes/spherical_harmonics.h"
#include "bake/surface/patch_set.h"
#include "bake/trace/make_tracer.h"
#include "bake/vk/device.h"

namespace relume {

/// A probe looks along six axes, so that cosine-distributed directions cover the sphere.
constexpr uint32_t kProbeFaces = 6;

/// What probes see: traced once, it serves any light of the same surfaces.
struct ProbeLinks {
    std::vector<glm::vec3> points = {}; // of the probes [m]
    uint32_t samples = 0;               // directions per face
    std::vector<uint32_t> links = {};   // [probe][face][sample], as ClosestWork has them
    uint32_t targets = 0;               // rays per probe to analytic lights
    std::vector<uint8_t> seen = {};     // [probe][target]: 1 where nothing is in between
    uint64_t rays = 0;
};

struct ProbeDesc {
    uint32_t samples = 4096;                // directions per face, a multiple of 8
    TracerKind tracer = TracerKind::Embree; // not Auto
};

/// Returns direction `sample` of a face of a probe, unit: the one that tracers take.
glm::vec3 probeDirection(uint32_t probe, uint32_t face, uint32_t sample);

/// Returns the solid angle [sr] that a direction stands for: those of all faces together have the density
/// (|x| + |y| + |z|) / (6 pi), which is nowhere below 1 / (6 pi) [Veach and Guibas 1995, balance heuristic].
double probeSolidAngle(const glm::vec3& direction, uint32_t samples);

/// Traces the links of probes at these points, and rays to analytic lights (`lamps` without a sky, whose
/// light comes by links). The tracer is one of its own, over the patches with the probes' faces behind them.
/// Throws Error.
ProbeLinks traceProbes(const vk::Device& device, const PatchSet& patches, const LampSet& lamps,
                       std::vector<glm::vec3> points, const ProbeDesc& desc);

/// What shines on probes: all that may change without a ray.
struct ProbeLight {
    std::span<const glm::vec4> radiance = {}; // per patch [cd/m^2], what it sends
    const Sky* sky = nullptr;                 // nullptr: none
    std::span<const shader::Lamp> lamps = {}; // as they were traced; colours may differ
};

/// A probe's result.
struct Probe {
    glm::vec3 position{0.0f};                   // [m]
    Harmonics radiance{};                       // [cd/m^2]
    double backs = 0;                           // share of the sphere on which it sees backs of surfaces
    bool inside() const { return backs > 0.5; } // behind or within walls: its light means nothing
};

/// Sums light over links; no rays. Mesh lights shine by the links that meet them, the sky by those that meet
/// nothing, analytic lights by their own rays, so that nothing counts twice.
std::vector<Probe> gatherProbes(const ProbeLinks& links, const ProbeLight& light);

/// Returns what each patch sends [cd/m^2] under this lighting: emission + reflectivity x albedo x lighting.
std::vector<glm::vec4> patchRadiance(const PatchSet& patches, const std::vector<glm::vec4>& lighting,
                                     float reflectivity);

} // namespace relume
