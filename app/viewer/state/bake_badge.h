#pragma once

#include <string>

#include "app/live/live_bake.h"

namespace relume {

/// Tells how far the light on screen is what the document asks for.
struct BakeBadge {
    enum class State {
        None,     // no scene, or no bake
        Stale,    // some light is from before the newest edit
        Refining, // the light is that of this document, and becomes better
        Paused,
        Converged,
    };
    State state = State::None;
    std::string text; // one line; "" for None
};

struct BakeBadgeDesc {
    const BakeStatus& status;
    const PublishedMap* map = nullptr; // the one that is shown
    uint64_t newestBake = 0;           // of the document
    std::string edit;                  // name of the newest one, "": none
    double seconds = 0; // since it, or since the scene came, up to when the light had converged
};
BakeBadge bakeBadge(const BakeBadgeDesc& desc);
/// Returns what the level on screen has that its file lacks, "" where that is nothing.
std::string furnishedText(bool madeUvs, bool previewLight);
const char* badgeName(BakeBadge::State state); // "converged"

} // namespace relume
