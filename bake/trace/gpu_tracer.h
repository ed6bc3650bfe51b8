#pragma once

#include <memory>

#include "bake/trace/tracer.h"

namespace relume {

// The tracers that run on the Vulkan device. Each builds its acceleration structure and throws Error when it
// cannot.
std::unique_ptr<Tracer> makePipelineTracer(const vk::Device& device, const TraceScene& scene,
                                           const vk::Buffer& patches);
std::unique_ptr<Tracer> makeQueryTracer(const vk::Device& device, const TraceScene& scene,
                                        const vk::Buffer& patches);
std::unique_ptr<Tracer> makeBvhTracer(const vk::Device& device, const TraceScene& scene,
                                      const vk::Buffer& patches);

} // namespace relume
