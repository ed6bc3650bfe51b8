#include "bake/links/direct_submit.h"

namespace relume {

void DirectSubmit::begin() {
    portions_ = 0;
    if (!records_) return;
    commands_ = kit_.commands.begin();
    kit_.timestamps.reset(commands_);
}

void DirectSubmit::finish() {
    if (!records_) return;
    kit_.run(commands_);
    for (uint32_t mark = 0; mark < 3 * portions_; mark += 3) {
        kit_.progress.traceSeconds += 1e-3 * kit_.timestamps.milliseconds(mark, mark + 1);
        kit_.progress.gatherSeconds += 1e-3 * kit_.timestamps.milliseconds(mark + 1, mark + 2);
    }
}

} // namespace relume
