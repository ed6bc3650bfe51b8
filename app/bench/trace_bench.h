#pragma once

#include "bake/baker/baker.h"
#include "bake/trace/make_tracer.h"

namespace relume {

/// The rates of one tracer's real kernels on one scene and lightmap size.
struct TraceRates {
    std::string tracer;
    uint32_t size = 0, patches = 0, triangles = 0;
    double occlusion = 0;       // [rays/s] facing pairs traced, kernels alone
    double occlusionGather = 0; // [rays/s] with transposition and gather
    double gather = 0;          // [pairs/s] receiver-sender pairs, kernels alone
    double closestPatch = 0;    // [rays/s] directions of each patch's own
    double closestTile = 0;     // [rays/s] directions shared by a chunk
};

struct TraceBenchDesc {
    double seconds = 2.0;  // about, for each of occlusion and both kinds of closest
    double batchMs = 20.0; // how long one submit should take
};

/// Runs the kernels over an even sample of the baker's super-blocks and chunks, everything sending. GPU
/// tracers are timed by GPU timestamps, the CPU tracer by the wall clock. Throws Error.
TraceRates measureTracer(const vk::Device& device, Baker& baker, TracerKind kind, const TraceBenchDesc& desc);

} // namespace relume
