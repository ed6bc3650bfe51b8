#include "bake/direct/point_trace.h"

#include "assets/base/clock.h"

namespace relume {

void recordPoints(VkCommandBuffer cmd, const PointTracer& on, const SegmentWork& work,
                  const std::function<void(VkCommandBuffer)>& samples,
                  const std::function<void(VkCommandBuffer)>& gather, uint32_t mark) {
    samples(cmd);
    vk::barrier(cmd);
    on.timestamps.mark(cmd, mark);
    on.tracer.segments(cmd, work);
    vk::barrier(cmd);
    on.timestamps.mark(cmd, mark + 1);
    gather(cmd);
    on.timestamps.mark(cmd, mark + 2);
    vk::barrier(cmd);
}

PointTimes tracePoints(const PointTracer& on, const SegmentWork& work,
                       const std::function<void(VkCommandBuffer)>& samples,
                       const std::function<void(VkCommandBuffer)>& gather) {
    PointTimes times;
    VkCommandBuffer cmd = on.commands.begin();
    if (on.tracer.onCpu()) {
        samples(cmd);
        vk::barrier(cmd);
        vk::hostBarrier(cmd);
        on.commands.run();
        cmd = on.commands.begin();
        const auto start = Clock::now();
        on.tracer.segments(cmd, work);
        times.trace = secondsSince(start);
        on.timestamps.reset(cmd);
        vk::barrier(cmd);
        on.timestamps.mark(cmd, 1);
        gather(cmd);
        on.timestamps.mark(cmd, 2);
        vk::barrier(cmd);
    } else {
        on.timestamps.reset(cmd);
        recordPoints(cmd, on, work, samples, gather);
    }
    vk::hostBarrier(cmd);
    on.commands.run();
    if (!on.tracer.onCpu()) times.trace = 1e-3 * on.timestamps.milliseconds(0, 1);
    times.gather = 1e-3 * on.timestamps.milliseconds(1, 2);
    return times;
}

PointTimes tracePointsOnCpu(const PointsOnCpu& on, const SegmentWork& work,
                            const std::function<void()>& samples, const std::function<void()>& gather) {
    samples();
    PointTimes times;
    const auto start = Clock::now();
    on.tracer.segments(VK_NULL_HANDLE, work);
    times.trace = secondsSince(start);
    const auto traced = Clock::now();
    gather();
    times.gather = secondsSince(traced);
    return times;
}

} // namespace relume
