#pragma once

#include <memory>

#include "bake/trace/moving_bvh.h"
#include "bake/trace/tracer.h"
#include "bake/trace/voxel_map.h"

namespace relume {

// These make the tracers that run on the Vulkan device. Each builds its acceleration structure and throws
// Error when it cannot.
std::unique_ptr<Tracer> makePipelineTracer(const vk::Device& device, const TraceScene& scene,
                                           const vk::Buffer& patches);
std::unique_ptr<Tracer> makeQueryTracer(const vk::Device& device, const TraceScene& scene,
                                        const vk::Buffer& patches);
std::unique_ptr<Tracer> makeBvhTracer(const vk::Device& device, const TraceScene& scene,
                                      const vk::Buffer& patches, MovingBvh tree);
/// Makes the tracer that marches through a voxel map; bake/trace/README.md says what that costs in accuracy.
/// With a ratio above 1 it leaves the bits and links of all other senders and samples as they are in the
/// work's buffers.
std::unique_ptr<Tracer> makeVoxelTracer(const vk::Device& device, const TraceScene& scene,
                                        const vk::Buffer& patches, const VoxelSettings& settings);

} // namespace relume
