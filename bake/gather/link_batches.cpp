#include "bake/gather/link_batches.h"

#include "assets/base/clock.h"

#include <algorithm>

namespace relume {
namespace {

void record(const std::function<void(VkCommandBuffer)>& step, VkCommandBuffer cmd) {
    if (step) step(cmd);
}

} // namespace

LinkBatches::Portion LinkBatches::next(uint32_t samplePass, double spent) {
    const uint32_t first = kit_.order.next(1, 0).first;
    const LinkCache::Place place = cache_.find(samplePass, first, kit_.order.count() - first);
    const bool trace = !place.known;
    const ChunkRange range = trace
                                 ? kit_.nextRange(traceRate_, std::min(place.count, kit_.buffers.batchChunks))
                                 : kit_.nextRange(gatherRate_, place.count, 1, spent);
    return {.trace = trace,
            .range = range,
            .closest = closestWork(samplePass, 1, place, range),
            .gather = {.links = place.links,
                       .linksOffset = place.offset,
                       .samples = kit_.linksOfSamplePass,
                       .range = range}};
}

LinkBatches::Portion LinkBatches::nextOnce(uint32_t samplePass, uint32_t samplePasses) {
    const LinkCache::Place place = cache_.passing(samplePasses, kit_.order.count());
    const ChunkRange range = kit_.nextRange(traceRate_, place.count, samplePasses);
    return {.trace = true,
            .once = true,
            .samplePasses = samplePasses,
            .range = range,
            .closest = closestWork(samplePass, samplePasses, place, range),
            .gather = {.links = place.links,
                       .linksOffset = place.offset,
                       .samples = samplePasses * kit_.linksOfSamplePass,
                       .range = range}};
}

ClosestWork LinkBatches::closestWork(uint32_t samplePass, uint32_t samplePasses,
                                     const LinkCache::Place& place, ChunkRange range) const {
    return {.firstChunk = range.first,
            .chunkCount = range.count,
            .firstSample = samplePass * kit_.linksOfSamplePass,
            .sampleCount = samplePasses * kit_.linksOfSamplePass,
            .rotation = kit_.settings.links.rotation,
            .links = place.links,
            .linksOffset = place.offset,
            .covers = kit_.covers()};
}

void LinkBatches::finish(uint32_t samplePass, const Portion& portion) {
    if (!portion.once) cache_.note(samplePass, portion.range);
    kit_.order.finish(portion.range);
}

void LinkBatches::run(const Portion& portion, const Steps& steps, bool atOnce) {
    const auto start = Clock::now();
    atOnce ? runAtOnce(portion, steps) : runBySubmit(portion, steps);
    (portion.trace ? traceRate_ : gatherRate_)
        .note(double(portion.range.count) * portion.samplePasses, kit_.batchMs, secondsSince(start));
}

void LinkBatches::runAtOnce(const Portion& portion, const Steps& steps) {
    record(steps.begin, VK_NULL_HANDLE);
    const auto start = Clock::now();
    if (portion.trace) kit_.input.tracer.closest(VK_NULL_HANDLE, portion.closest);
    const double traced = secondsSince(start);
    record(steps.traced, VK_NULL_HANDLE);
    steps.gather(VK_NULL_HANDLE);
    kit_.progress.traceSeconds += traced;
    kit_.progress.gatherSeconds += secondsSince(start) - traced;
    if (!steps.endRecords()) return record(steps.end, VK_NULL_HANDLE);
    VkCommandBuffer cmd = kit_.commands.begin();
    record(steps.end, cmd);
    kit_.run(cmd);
}

void LinkBatches::runBySubmit(const Portion& portion, const Steps& steps) {
    vk::Timestamps& timestamps = kit_.timestamps;
    VkCommandBuffer cmd = kit_.commands.begin();
    record(steps.begin, cmd);
    timestamps.reset(cmd);
    timestamps.mark(cmd, 0);
    const auto start = Clock::now();
    if (portion.trace) kit_.input.tracer.closest(cmd, portion.closest);
    const double cpuTrace = secondsSince(start);
    vk::barrier(cmd);
    timestamps.mark(cmd, 1);
    record(steps.traced, cmd);
    if (kit_.gatherPass.onCpu()) { // which then counts into the time between the same two marks
        kit_.run(cmd);
        cmd = kit_.commands.begin();
    }
    steps.gather(cmd);
    timestamps.mark(cmd, 2);
    record(steps.end, cmd);
    kit_.run(cmd);
    kit_.progress.traceSeconds +=
        kit_.input.tracer.onCpu() && portion.trace ? cpuTrace : 1e-3 * timestamps.milliseconds(0, 1);
    kit_.progress.gatherSeconds += 1e-3 * timestamps.milliseconds(1, 2);
}

} // namespace relume
