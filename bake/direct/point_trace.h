#pragma once

#include <functional>

#include "bake/trace/tracer.h"
#include "bake/vk/commands.h"

namespace relume {

/// What one batch of rays to points on lights runs on.
struct PointTracer {
    vk::Commands& commands;
    vk::Timestamps& timestamps; // three marks
    Tracer& tracer;
};

/// [s]
struct PointTimes {
    double trace = 0, gather = 0;
};

/// Draws points, traces rays to them and gathers their light: recorded only, with a tracer that records.
/// Barriers between the three and behind are its own; marks: three from `mark` on, between which tracing and
/// gathering lie.
void recordPoints(VkCommandBuffer cmd, const PointTracer& on, const SegmentWork& work,
                  const std::function<void(VkCommandBuffer)>& samples,
                  const std::function<void(VkCommandBuffer)>& gather, uint32_t mark = 0);
/// Draws points, traces rays to them and gathers their light, waited for. Barriers around what samples and
/// gather record are its own.
PointTimes tracePoints(const PointTracer& on, const SegmentWork& work,
                       const std::function<void(VkCommandBuffer)>& samples,
                       const std::function<void(VkCommandBuffer)>& gather);

} // namespace relume
