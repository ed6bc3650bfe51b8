#include "bake/gather/link_batches.h"

#include "assets/base/clock.h"

#include <algorithm>

namespace relume {
namespace {

// A batch has at most so many runs of chunks, and no more of them where it has this share of what it is to
// have.
constexpr size_t kMostRuns = 64;
constexpr double kFullBatch = 0.75;

void record(const std::function<void(VkCommandBuffer)>& step, VkCommandBuffer cmd) {
    if (step) step(cmd);
}

} // namespace

LinkBatches::Portion LinkBatches::next(uint32_t samplePass, double spent) {
    const uint32_t first = kit_.order.next(1, 0).first;
    const auto before = static_cast<uint32_t>(spent);
    const LinkCache::Place place = cache_.find(samplePass, first, kit_.order.count() - first, before);
    const bool trace = !place.known;
    const uint32_t most = kit_.buffers.batchChunks - std::min(before, kit_.buffers.batchChunks);
    if (place.count == 0 || (trace && most == 0)) return {.trace = trace};
    const ChunkRange range = trace ? kit_.nextRange(traceRate_, std::min(place.count, most), 1, spent)
                                   : kit_.nextRange(gatherRate_, place.count, 1, spent);
    return {.trace = trace,
            .range = range,
            .closest = closestWork(samplePass, 1, place, range),
            .gather = {.links = place.links,
                       .linksOffset = place.offset,
                       .samples = kit_.linksOfSamplePass,
                       .range = range}};
}

std::vector<LinkBatches::Portion> LinkBatches::take(uint32_t samplePass) {
    std::vector<Portion> portions;
    double spent = 0;
    while (kit_.order.left() > 0 && portions.size() < kMostRuns) {
        const Portion portion = next(samplePass, spent);
        const bool first = portions.empty();
        if (!first && (portion.trace != portions.front().trace || portion.range.count == 0)) break;
        kit_.order.finish(portion.range);
        portions.push_back(portion);
        spent += portion.range.count;
        const double wanted = (portion.trace ? traceRate_ : gatherRate_).wanted(kit_.batchMs);
        if (kit_.rankChunks.alone() || spent > kFullBatch * wanted) break;
    }
    return portions;
}

LinkBatches::Portion LinkBatches::takeOnce(uint32_t samplePass, uint32_t samplePasses) {
    const LinkCache::Place place = cache_.passing(samplePasses, kit_.order.count());
    const ChunkRange range = kit_.nextRange(traceRate_, place.count, samplePasses);
    kit_.order.finish(range);
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

void LinkBatches::run(std::span<const Portion> portions, const Steps& steps, bool atOnce) {
    ASSERT(!portions.empty());
    const auto start = Clock::now();
    double beside = 0; // [s]
    if (atOnce)
        runAtOnce(portions, steps);
    else
        beside = runBySubmit(portions, steps);
    double chunks = 0;
    for (const Portion& portion : portions)
        chunks += double(portion.range.count) * portion.samplePasses;
    (portions.front().trace ? traceRate_ : gatherRate_)
        .note(chunks, kit_.batchMs, secondsSince(start) - beside);
}

void LinkBatches::trace(std::span<const Portion> portions, VkCommandBuffer cmd) const {
    for (const Portion& portion : portions)
        if (portion.trace) kit_.input.tracer.closest(cmd, portion.closest);
}

void LinkBatches::runAtOnce(std::span<const Portion> portions, const Steps& steps) {
    record(steps.begin, VK_NULL_HANDLE);
    const auto start = Clock::now();
    trace(portions, VK_NULL_HANDLE);
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

double LinkBatches::runBySubmit(std::span<const Portion> portions, const Steps& steps) {
    vk::Timestamps& timestamps = kit_.timestamps;
    VkCommandBuffer cmd = kit_.commands.begin();
    record(steps.begin, cmd);
    timestamps.reset(cmd);
    timestamps.mark(cmd, 0);
    const auto start = Clock::now();
    trace(portions, cmd);
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
    double meanwhile = 0;
    kit_.run(cmd, [&] {
        if (!steps.meanwhile) return;
        const auto begun = Clock::now();
        steps.meanwhile();
        meanwhile = secondsSince(begun);
    });
    kit_.progress.traceSeconds +=
        kit_.input.tracer.onCpu() && portions.front().trace ? cpuTrace : 1e-3 * timestamps.milliseconds(0, 1);
    kit_.progress.gatherSeconds += 1e-3 * timestamps.milliseconds(1, 2);
    return std::max(meanwhile - 1e-3 * timestamps.milliseconds(0, 2), 0.0);
}

} // namespace relume
