#include "bake/links/direct_submit.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace relume {

void DirectSubmit::begin() {
    portions_ = 0;
    if (!records_) return;
    commands_ = kit_.commands.begin();
    kit_.timestamps.reset(commands_);
}

uint32_t DirectSubmit::nextMark() {
    ASSERT(records_);
    if (portions_ == LinkKit::kMostPortions) {
        finish(false);
        begin();
    }
    return 3 * portions_++;
}

void DirectSubmit::note(const PointTimes& times) {
    kit_.progress.traceSeconds += times.trace;
    kit_.progress.gatherSeconds += times.gather;
}

void DirectSubmit::countRaysOnCpu() {
    const std::span<uint32_t> counters(kit_.buffers.rays.as<uint32_t>(), shader::kRayCounters);
    kit_.progress.rays = std::accumulate(counters.begin(), counters.end(), kit_.progress.rays);
    std::fill(counters.begin(), counters.end(), 0u);
}

void DirectSubmit::finish(bool last) {
    if (!records_ && last) countRaysOnCpu();
    if (!records_) return;
    if (last) kit_.recordRayCount(commands_);
    kit_.run(commands_);
    if (last) kit_.countRays();
    for (uint32_t mark = 0; mark < 3 * portions_; mark += 3)
        note({.trace = 1e-3 * kit_.timestamps.milliseconds(mark, mark + 1),
              .gather = 1e-3 * kit_.timestamps.milliseconds(mark + 1, mark + 2)});
}

} // namespace relume
