#include "bake/links/direct_submit.h"

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
        finish();
        begin();
    }
    return 3 * portions_++;
}

void DirectSubmit::note(const PointTimes& times) {
    kit_.progress.traceSeconds += times.trace;
    kit_.progress.gatherSeconds += times.gather;
}

void DirectSubmit::finish() {
    if (!records_) return;
    kit_.run(commands_);
    for (uint32_t mark = 0; mark < 3 * portions_; mark += 3)
        note({.trace = 1e-3 * kit_.timestamps.milliseconds(mark, mark + 1),
              .gather = 1e-3 * kit_.timestamps.milliseconds(mark + 1, mark + 2)});
}

} // namespace relume
