#pragma once

#include "bake/direct/point_trace.h"
#include "bake/gather/link_kit.h"

namespace relume {

/// One submit of portions of direct light, of a tracer that records. With one that does not, portions are
/// made at once, and there are no commands.
class DirectSubmit {
public:
    explicit DirectSubmit(LinkKit& kit) : kit_(kit), records_(!kit.input.tracer.onCpu()) { begin(); }

    /// Tells whether portions are recorded.
    bool records() const { return records_; }
    /// Returns the first of the next portion's three marks. Submits what is recorded where no marks are left.
    uint32_t nextMark();
    /// Returns what the portion whose marks were asked for is recorded to.
    VkCommandBuffer commands() const { return commands_; }
    /// Takes note of the times of a portion that was made at once.
    void note(const PointTimes& times);
    /// Tells whether another portion may go into the same submit.
    bool goesOn() const { return records_ && portions_ < LinkKit::kMostPortions; }
    /// Submits and waits, and takes note of the times; after the last portion of a pass of its rays, too.
    void finish(bool last);

private:
    void begin();
    void countRaysOnCpu();

    LinkKit& kit_;
    bool records_;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    uint32_t portions_ = 0;
};

} // namespace relume
