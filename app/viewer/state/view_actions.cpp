#include "app/viewer/state/view_actions.h"

#include "app/viewer/state/views.h"

#include <fmt/format.h>

namespace relume {
namespace {

constexpr float kExposureStep = 0.25f; // [EV] of a key press

template<typename T>
void chooseNext(T& choice, size_t count) {
    choice = static_cast<T>((static_cast<size_t>(choice) + 1) % count);
}

} // namespace

std::string changeView(ViewState& view, Action action, int argument, float exposure) {
    switch (action) {
    case Action::View:
        view.view = static_cast<size_t>(argument);
        return "";
    case Action::UvTexture:
        view.uv = !view.uv;
        return "";
    case Action::Masked:
        view.masked = !view.masked;
        return "";
    case Action::NextFilter:
        chooseNext(view.filter, filterNames().size());
        return "lightmap filter: " + filterNames()[static_cast<size_t>(view.filter)];
    case Action::NextTone:
        chooseNext(view.tone, toneNames().size());
        return "tone mapping: " + toneNames()[static_cast<size_t>(view.tone)];
    case Action::AutomaticExposure:
        view.exposure = view.exposure ? std::nullopt : std::optional(exposure);
        return "";
    default: {
        const float step = action == Action::Brighter ? kExposureStep : -kExposureStep;
        view.exposure = view.exposure.value_or(exposure) + step;
        return fmt::format("exposure {:+.2f} EV", *view.exposure);
    }
    }
}

bool comparesLight(const ViewState& view) {
    const ViewEntry& entry = viewEntries()[view.view];
    return !view.uv && readsLightmap(entry.view) && showsLight(entry.view) &&
           entry.content == MapContent::Light && !entry.voxels;
}

} // namespace relume
