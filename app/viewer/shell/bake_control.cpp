#include "app/viewer/shell/bake_control.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

constexpr double kMovingShare = 0.25; // of the budget: what a batch has while the camera moves
constexpr double kLeastBatchMs = 1;
constexpr uint64_t kMebi = uint64_t{1} << 20;

} // namespace

bool BakeControl::busy() const {
    return status_.phase == BakeStatus::Phase::Baking || status_.phase == BakeStatus::Phase::Preparing;
}

void BakeControl::perform(Action action) {
    if (session_.scene() == nullptr) return feedback_.note("there is no scene to bake", true);
    const bool done = status_.phase == BakeStatus::Phase::Done && status_.bake == session_.newestBake();
    if (action != Action::Reset && done)
        return feedback_.note("the bake is done: an edit or Reset (Ctrl+R) begins anew");
    switch (action) {
    case Action::MakePass:
        return bake_.makePass();
    case Action::Step:
        return bake_.step();
    case Action::Reset:
        return bake_.reset();
    default:
        break;
    }
    if (status_.phase == BakeStatus::Phase::Paused)
        bake_.resume();
    else
        bake_.pause();
}

void BakeControl::abortPass() {
    if (status_.phase == BakeStatus::Phase::Baking) bake_.abortPass();
}

void BakeControl::follow() {
    BakeStatus status = bake_.status();
    tellLinks(status); // before the end of a bake is told, which has them all
    // An edit may be answered between two looks: then the bake was done before, and is done again.
    if (status.phase != status_.phase ||
        (status.bake != status_.bake && status.phase == BakeStatus::Phase::Done)) {
        feedback_.pacer().input();
        feedback_.tell("bake", phaseName(status.phase));
    }
    const bool doesOther = status.doing != status_.doing;
    status_ = std::move(status);
    if (busy() || session_.loading() || doesOther) feedback_.pacer().statusChanged();
}

// Tells how much device memory keeps links: it grows while the light converges, and nobody else's does.
void BakeControl::tellLinks(const BakeStatus& status) {
    const uint64_t links = status.progress.cacheBytes / kMebi;
    if (links == linksTold_) return;
    linksTold_ = links;
    feedback_.tell("links", std::to_string(links) + " MiB");
}

void BakeControl::setBudget(double budgetMs, bool moves) {
    const double wanted = moves ? std::max(kMovingShare * budgetMs, kLeastBatchMs) : budgetMs;
    if (wanted == batchMs_) return;
    batchMs_ = wanted;
    bake_.setBatchMs(wanted);
}

} // namespace relume
