#pragma once

#include <memory>
#include <string>

#include "bake/trace/tracer.h"
#include "bake/trace/tree_ahead.h"
#include "bake/trace/voxel_map.h"

namespace relume {

enum class TracerKind { Auto, Rtp, Query, Bvh, Embree, Voxel };

/// Throws UsageError for an unknown name.
TracerKind parseTracerKind(const std::string& name);
/// Returns the tracer Auto stands for on this device, with the reason in `why`: rtp where the GPU has RT
/// cores, bvh on other GPUs, embree on a software device.
TracerKind chooseTracer(const vk::DeviceInfo& info, std::string& why);
/// Returns what `kind` needs and the device lacks; "" when it can run there.
std::string tracerProblem(TracerKind kind, const vk::DeviceInfo& info);
const char* tracerName(TracerKind kind);

/// Makes a tracer and builds its acceleration structure. `patches` holds scene.patches on the device.
/// `voxels` is for the voxel tracer: a ratio of 1 makes that one, whatever the kind; with a ratio above 1 it
/// takes its share of the work of a tracer of another kind (mixed_tracer.h). With the scene's `tree`, which
/// then is taken, a `bvh` tracer builds none. Throws Error when the device cannot.
std::unique_ptr<Tracer> makeTracer(TracerKind kind, const vk::Device& device, const TraceScene& scene,
                                   const vk::Buffer& patches, const VoxelSettings& voxels = {},
                                   TreeAhead* tree = nullptr);

} // namespace relume
