#pragma once

#include "app/live/session.h"
#include "app/viewer/state/feedback.h"
#include "app/viewer/state/shortcuts.h"

namespace relume {

/// Runs the bake as keys ask, follows its status, and leaves it less time while the camera moves.
class BakeControl {
public:
    /// All that it is given must outlive it; `batchMs` is what the bake was told at first.
    BakeControl(const Session& session, LiveBake& bake, Feedback& feedback, double batchMs)
        : session_(session), bake_(bake), feedback_(feedback), batchMs_(batchMs) {}

    /// Returns the status as it was when follow() looked last.
    const BakeStatus& status() const { return status_; }
    /// Tells whether light comes, or is about to.
    bool busy() const;
    /// Does an action from MakePass to Reset.
    void perform(Action action);
    /// Gives up the pass under way, where there is one.
    void abortPass();
    void follow();
    /// Says how long a batch should take while the camera is still [ms], and whether it moves.
    void setBudget(double budgetMs, bool moves);

private:
    void tellLinks(const BakeStatus& status);

    const Session& session_;
    LiveBake& bake_;
    Feedback& feedback_;
    BakeStatus status_;
    double batchMs_;         // what the bake was told
    uint64_t linksTold_ = 0; // the memory of links [MiB] as it was told last
};

} // namespace relume
