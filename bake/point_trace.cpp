#include "bake/point_trace.h"

#include "assets/clock.h"

namespace relume {

PointTimes tracePoints(const PointTracer& on, const SegmentWork& work,
                       const std::function<void(VkCommandBuffer)>& samples,
                       const std::function<void(VkCommandBuffer)>& gather) {
    PointTimes times;
    const bool onCpu = on.tracer.onCpu();
    VkCommandBuffer cmd = on.commands.begin();
    samples(cmd);
    vk::barrier(cmd);
    if (onCpu) {
        vk::hostBarrier(cmd);
        on.commands.run();
        cmd = on.commands.begin();
        const auto start = Clock::now();
        on.tracer.segments(cmd, work);
        times.trace = secondsSince(start);
    }
    on.timestamps.reset(cmd);
    on.timestamps.mark(cmd, 0);
    if (!onCpu) on.tracer.segments(cmd, work);
    vk::barrier(cmd);
    on.timestamps.mark(cmd, 1);
    gather(cmd);
    on.timestamps.mark(cmd, 2);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    on.commands.run();
    if (!onCpu) times.trace = 1e-3 * on.timestamps.milliseconds(0, 1);
    times.gather = 1e-3 * on.timestamps.milliseconds(1, 2);
    return times;
}

} // namespace relume
