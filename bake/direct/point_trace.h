#pragma once

#include <functional>

#include "assets/base/worker_pool.h"
#include "bake/trace/tracer.h"
#include "bake/vk/commands.h"

namespace relume {

/// So many sample passes at most are one Work of mesh lights or of analytic ones.
constexpr uint32_t kMostTogether = 16;
static_assert(kMostTogether >= shader::kSamplePassesTogether);

/// The means by which one batch of rays to points on lights runs.
struct PointTracer {
    vk::Commands& commands;
    vk::Timestamps& timestamps; // three marks
    Tracer& tracer;
};

/// The times of one batch [s].
struct PointTimes {
    double trace = 0, gather = 0;
};

/// Records to draw points, trace rays to them and gather their light, with a tracer that records. It writes
/// the barriers between the three and behind them, and three marks from `mark` on, between which tracing and
/// gathering lie.
void recordPoints(VkCommandBuffer cmd, const PointTracer& on, const SegmentWork& work,
                  const std::function<void(VkCommandBuffer)>& samples,
                  const std::function<void(VkCommandBuffer)>& gather, uint32_t mark = 0);
/// Draws points, traces rays to them, gathers their light and waits. It writes the barriers around what
/// samples and gather record.
PointTimes tracePoints(const PointTracer& on, const SegmentWork& work,
                       const std::function<void(VkCommandBuffer)>& samples,
                       const std::function<void(VkCommandBuffer)>& gather);

/// The means by which one batch runs on the CPU alone, without the device; its light goes to these buffers.
struct PointsOnCpu {
    WorkerPool& pool;
    Tracer& tracer;
    const vk::Buffer &rays, &sums, &direct; // rays: as in SegmentWork
    bool newSums = false;                   // nothing is in the sums yet
};
/// Draws points, traces rays to them and gathers their light, at once.
PointTimes tracePointsOnCpu(const PointsOnCpu& on, const SegmentWork& work,
                            const std::function<void()>& samples, const std::function<void()>& gather);

} // namespace relume
