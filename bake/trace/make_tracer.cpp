#include "bake/trace/make_tracer.h"

#include "assets/base/error.h"
#include "bake/trace/embree_tracer.h"
#include "bake/trace/gpu_tracer.h"
#include "bake/trace/mixed_tracer.h"

#include <array>

namespace relume {
namespace {

struct TracerName {
    TracerKind kind;
    const char* name;
};
constexpr std::array<TracerName, 6> kTracerNames = {{{TracerKind::Auto, "auto"},
                                                     {TracerKind::Rtp, "rtp"},
                                                     {TracerKind::Query, "query"},
                                                     {TracerKind::Bvh, "bvh"},
                                                     {TracerKind::Embree, "embree"},
                                                     {TracerKind::Voxel, "voxel"}}};

} // namespace

TracerKind parseTracerKind(const std::string& name) {
    for (const TracerName& n : kTracerNames) {
        if (name == n.name) return n.kind;
    }
    throw UsageError("--tracer " + name + ": unknown; choose auto, rtp, query, bvh, embree or voxel");
}

const char* tracerName(TracerKind kind) {
    for (const TracerName& n : kTracerNames) {
        if (kind == n.kind) return n.name;
    }
    return "";
}

TracerKind chooseTracer(const vk::DeviceInfo& info, std::string& why) {
    if (info.software()) {
        why = "software device";
        return TracerKind::Embree;
    }
    if (info.rayTracingCores()) {
        why = "ray tracing cores";
        return TracerKind::Rtp;
    }
    why =
        info.rayTracingPipeline ? "the driver emulates its ray tracing pipeline" : "no ray tracing pipeline";
    return TracerKind::Bvh;
}

std::string tracerProblem(TracerKind kind, const vk::DeviceInfo& info) {
    if (kind == TracerKind::Rtp && !info.rayTracingPipeline) return "VK_KHR_ray_tracing_pipeline is missing";
    if (kind == TracerKind::Query && !info.rayQuery) return "VK_KHR_ray_query is missing";
    // The CPU writes bits and links straight into the device's memory.
    if (kind == TracerKind::Embree && !info.software())
        return "its results would have to cross the bus: embree goes with a software device";
    if (kind == TracerKind::Voxel && !info.fragmentStores) return "fragmentStoresAndAtomics is missing";
    return "";
}

namespace {

void checkTracer(TracerKind kind, const vk::Device& device) {
    const std::string problem = tracerProblem(kind, device.info());
    if (problem.empty()) return;
    throw Error(std::string("tracer ") + tracerName(kind) + " cannot run on '" + device.info().name +
                "': " + problem + " (relume devices lists what can)");
}

} // namespace

std::unique_ptr<Tracer> makeTracer(TracerKind kind, const vk::Device& device, const TraceScene& scene,
                                   const vk::Buffer& patches, const VoxelSettings& voxels, TreeAhead* tree) {
    std::string why;
    if (voxels.ratio == 1) kind = TracerKind::Voxel;
    if (kind == TracerKind::Auto) kind = chooseTracer(device.info(), why);
    checkTracer(kind, device);
    if (voxels.ratio > 1 && kind != TracerKind::Voxel) {
        checkTracer(TracerKind::Voxel, device);
        return makeMixedTracer(device, makeTracer(kind, device, scene, patches, {}, tree),
                               makeVoxelTracer(device, scene, patches, voxels));
    }
    switch (kind) {
    case TracerKind::Rtp:
        return makePipelineTracer(device, scene, patches);
    case TracerKind::Query:
        return makeQueryTracer(device, scene, patches);
    case TracerKind::Bvh:
        return makeBvhTracer(device, scene, patches,
                             tree ? tree->take() : MovingBvh(scene.mesh, &device.workers()));
    case TracerKind::Voxel:
        return makeVoxelTracer(device, scene, patches, {.resolution = voxels.resolution});
    default:
        return makeEmbreeTracer(scene, device.workers());
    }
}

} // namespace relume
