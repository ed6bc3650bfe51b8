#include "app/viewer/state/light_progress.h"

#include <algorithm>
#include <utility>

namespace relume {

void LightProgress::sceneCame(double time) {
    edit_.clear();
    editedAt_ = time;
}

void LightProgress::edited(const std::string& name, bool goesOn, double time) {
    if (!goesOn) editedAt_ = time;
    edit_ = name;
}

bool LightProgress::update(const BakeStatus& status, const PublishedMap* map, uint64_t newestBake,
                           double time) {
    const double end = converged() ? convergedAt_ : time;
    BakeBadge badge = bakeBadge({.status = status,
                                 .map = map,
                                 .newestBake = newestBake,
                                 .edit = edit_,
                                 .seconds = std::max(end - editedAt_, 0.0)});
    // An edit may be answered between two looks: it had converged before, and has again.
    const uint64_t convergedBake = badge.state == BakeBadge::State::Converged ? newestBake : 0;
    const bool news = badge.state != badge_.state || (convergedBake != convergedBake_ && convergedBake != 0);
    if (news && convergedBake != 0) convergedAt_ = time;
    convergedBake_ = convergedBake;
    badge_ = std::move(badge);
    return news;
}

} // namespace relume
