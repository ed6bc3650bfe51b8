#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bake/lights/lamps.h"
#include "bake/surface/patch_set.h"
#include "bake/trace/make_tracer.h"
#include "bake/vk/device.h"

namespace relume {

/// A probe looks along six axes, so that cosine-distributed directions cover the sphere.
constexpr uint32_t kProbeFaces = 6;
/// So many rays go to each analytic light that has an extent.
constexpr uint32_t kProbeLampSamples = 64;

/// What probes see: traced once, it serves any light of the same surfaces.
struct ProbeLinks {
    uint32_t first = 0;                   // number of the first probe, which decides its directions
    std::vector<glm::vec3> points = {};   // of the probes [m]
    uint32_t samples = 0;                 // directions per face
    std::vector<uint32_t> links = {};     // [probe][face][sample], as ClosestWork has them
    std::vector<shader::Lamp> lamps = {}; // analytic lights as they stood; their colours say nothing
    uint32_t targets = 0;                 // rays per probe to all of them
    std::vector<uint8_t> seen = {};       // [probe][target]: 1 where nothing is in between
    uint64_t rays = 0;

    /// Returns the links of one probe, [face][sample].
    const uint32_t* linksOf(size_t probe) const { return links.data() + probe * kProbeFaces * samples; }
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

/// Returns the scene's analytic lights as probes trace them: one per Scene::lights, in their order, without
/// the sky, whose light comes by links.
LampSet probeLamps(const Scene& scene, const WorldMesh& mesh);

/// Traces what probes see. The tracer is one of its own, over the patches with the probes' faces behind them.
class ProbeTracer {
public:
    /// Takes where all probes stand, at least one. The device must outlive it; patches and lights are copied.
    /// Throws Error.
    ProbeTracer(const vk::Device& device, const PatchSet& patches, LampSet lamps,
                std::vector<glm::vec3> points, TracerKind kind);
    ~ProbeTracer();

    /// Returns the links of `count` probes from number `first` on, which is a multiple of kProbeStride,
    /// by so many directions per face, a multiple of 8.
    ProbeLinks trace(uint32_t first, uint32_t count, uint32_t samples);

    /// Follow probes that stand elsewhere now, from number `first` on, and analytic lights that do: the
    /// tracer stays as it is.
    void move(uint32_t first, const std::vector<glm::vec3>& points);
    void setLamps(LampSet lamps);

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// The faces of so many probes fill whole chunks.
constexpr uint32_t kProbeStride = 32;

/// Returns how many probes are traced at a time, a multiple of kProbeStride: their links fit into a few
/// megabytes, and a stop is heard in between.
uint32_t probeBatch(uint32_t samples);

/// Traces all of a few probes at once. Throws Error.
ProbeLinks traceProbes(const vk::Device& device, const PatchSet& patches, const LampSet& lamps,
                       std::vector<glm::vec3> points, const ProbeDesc& desc);

/// How many probes are baked, for the memory that they take.
struct ProbeExtent {
    uint32_t count = 0; // 0: none
    uint32_t samples = 4096;
    uint32_t targets = 0; // rays per probe to analytic lights
    uint32_t lights = 1;  // whose light is told apart
};

/// Returns the most device bytes that a ProbeTracer of these probes takes beside its tracer, while it traces
/// no more of them at a time than probeBatch() says. The scene has so many patches.
uint64_t probeTracerBytes(const ProbeExtent& extent, uint64_t patches);

} // namespace relume
