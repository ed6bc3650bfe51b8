#include "app/viewer/state/bake_badge.h"

#include <fmt/format.h>

namespace relume {
namespace {

using State = BakeBadge::State;
using Phase = BakeStatus::Phase;

State stateOf(const BakeBadgeDesc& desc) {
    const Phase phase = desc.status.phase;
    if (phase == Phase::Idle || phase == Phase::Failed || desc.newestBake == 0) return State::None;
    const bool follows = desc.status.bake == desc.newestBake && phase != Phase::Preparing;
    const bool shown = desc.map != nullptr && desc.map->bake == desc.newestBake;
    if (!follows || !shown) return State::Stale;
    // Before the first edit there is no light that could show another state of the scene.
    if (!desc.edit.empty() && !desc.status.stale.empty()) return State::Stale;
    if (phase == Phase::Done && desc.map->complete) return State::Converged;
    return phase == Phase::Paused ? State::Paused : State::Refining;
}

// Returns what the bake says about its layers, or before it knows of the edit, the edit's name.
std::string reasonOf(const BakeBadgeDesc& desc) {
    const std::vector<std::string>& stale = desc.status.stale;
    if (desc.status.bake != desc.newestBake || stale.empty()) return desc.edit;
    return stale.front() + (stale.size() > 1 ? fmt::format(" and {} more", stale.size() - 1) : "");
}

} // namespace

const char* badgeName(State state) {
    switch (state) {
    case State::None:
        return "none";
    case State::Stale:
        return "stale";
    case State::Refining:
        return "refining";
    case State::Paused:
        return "paused";
    case State::Converged:
        return "converged";
    }
    return "";
}

std::string furnishedText(bool madeUvs, bool previewLight) {
    if (!madeUvs) return previewLight ? "preview light: not in the file" : "";
    return std::string("lightmap UVs ") + (previewLight ? "made, preview light" : "made") +
           ": not in the file";
}

BakeBadge bakeBadge(const BakeBadgeDesc& desc) {
    BakeBadge badge{.state = stateOf(desc), .text = {}};
    if (badge.state == State::None) return badge;
    badge.text = badgeName(badge.state);
    if (badge.state == State::Stale) {
        if (const std::string reason = reasonOf(desc); !reason.empty()) badge.text += ": " + reason;
    } else if (desc.status.progress.error < 1.0) {
        badge.text += fmt::format(", error {:.2g}", desc.status.progress.error);
        if (desc.status.progress.localError95 < 1.0)
            badge.text += fmt::format(", local {:.2g}", desc.status.progress.localError95);
    }
    badge.text += fmt::format(", {:.1f} s", desc.seconds);
    return badge;
}

} // namespace relume
