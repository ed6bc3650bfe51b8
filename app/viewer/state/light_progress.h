#pragma once

#include <string>

#include "app/viewer/state/bake_badge.h"

namespace relume {

/// Follows how far the light is behind the edits, and for how long. The caller gives all times [s].
class LightProgress {
public:
    /// Says that another scene came, which nobody edited yet.
    void sceneCame(double time);
    /// Says that the document is edited. An edit that goes on (a drag) counts from its beginning.
    void edited(const std::string& name, bool goesOn, double time);
    /// Follows bake and map. Returns whether there is something to tell: another state, or light that
    /// converged anew. `map` is the one that is shown.
    bool update(const BakeStatus& status, const PublishedMap* map, uint64_t newestBake, double time);
    const BakeBadge& badge() const { return badge_; }
    bool converged() const { return badge_.state == BakeBadge::State::Converged; }

private:
    BakeBadge badge_;
    std::string edit_; // the name of the newest one, "": none since the scene came
    double editedAt_ = 0, convergedAt_ = 0;
    uint64_t convergedBake_ = 0; // the bake whose light had converged, 0: none
};

} // namespace relume
