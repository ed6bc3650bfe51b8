#pragma once

#include "bake/gather/link_kit.h"

namespace relume {

/// One submit of portions of direct light, of a tracer that records. With one that does not, portions are
/// made at once, and there are no commands.
class DirectSubmit {
public:
    explicit DirectSubmit(LinkKit& kit) : kit_(kit), records_(!kit.input.tracer.onCpu()) { begin(); }

    VkCommandBuffer commands() const { return commands_; }
    /// Submits what is recorded where the next portion has no marks of time left.
    void makeRoom() {
        if (portions_ < LinkKit::kMostPortions) return;
        finish();
        begin();
    }
    /// Returns the first of the next portion's three marks.
    uint32_t nextMark() { return records_ ? 3 * portions_++ : 0; }
    /// Tells whether another portion may go into the same submit.
    bool goesOn() const { return records_ && portions_ < LinkKit::kMostPortions; }
    /// Submits and waits, and takes note of the times.
    void finish();

private:
    void begin();

    LinkKit& kit_;
    bool records_;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    uint32_t portions_ = 0;
};

} // namespace relume
