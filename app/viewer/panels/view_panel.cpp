#include "app/viewer/panels/view_panel.h"

#include "app/viewer/panels/widgets.h"
#include "app/viewer/state/views.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

namespace relume {
namespace {

constexpr float kMostExposure = 24; // [EV] to either side that the slider reaches
constexpr uint32_t kMostMip = 4;    // of ligIn and ligOut
constexpr std::array<uint32_t, 4> kSamples = {0, 2, 4, 8};
constexpr std::array<uint32_t, 4> kPreviewVoxels = {32, 64, 128, 256};

void drawViews(const PanelContext& context) {
    const std::vector<ViewEntry>& entries = viewEntries();
    if (!ImGui::BeginTable("views", 2, ImGuiTableFlags_SizingStretchSame)) return;
    for (size_t i = 0; i < entries.size(); ++i) {
        ImGui::TableNextColumn();
        const Shortcut& shortcut = shortcutOf(Action::View, static_cast<int>(i));
        if (ui::selectable(entries[i].title, i == context.view.view))
            context.perform(Action::View, static_cast<int>(i));
        ui::tip(fmt::format("{} ({})", entries[i].tells, keyText(shortcut)).c_str());
    }
    ImGui::EndTable();
}

bool drawContent(const PanelContext& context) {
    ViewState& view = context.view;
    const ViewEntry& entry = viewEntries()[view.view];
    bool changed = false;
    if (entry.readsMap && hasMips(entry.content)) {
        int mip = static_cast<int>(view.mip);
        changed |= ui::sliderInt("Mip", &mip, 0, kMostMip);
        view.mip = static_cast<uint32_t>(std::clamp(mip, 0, static_cast<int>(kMostMip)));
        ui::tip("Means over 2^mip by 2^mip texels");
    }
    if (entry.content == MapContent::Leaves) {
        constexpr std::array<uint32_t, 6> kPreviewNodes = {2, 4, 8, 16, 32, 64};
        auto threshold = static_cast<float>(view.preview.threshold);
        changed |=
            ui::sliderFloat("Threshold", &threshold, 0.001f, 0.5f, "%.3f", ImGuiSliderFlags_Logarithmic);
        view.preview.threshold = threshold;
        changed |= ui::combo("Largest node [texels]", view.preview.node, kPreviewNodes);
        ui::tip("Of the preview, where the method has no quad-tree of its own");
    }
    if (entry.voxels) changed |= ui::combo("Voxels along an edge", view.voxels, kPreviewVoxels);
    const bool ranged = entry.content == MapContent::Error || entry.content == MapContent::Area;
    if (ranged && context.map != nullptr) {
        bool automatic = !view.high;
        if (ui::checkbox("Automatic range", &automatic)) {
            view.high = automatic ? std::nullopt : std::optional(context.map->high);
            changed = true;
        }
        float high = view.high.value_or(context.map->high);
        const ui::Disabled disabled(automatic);
        if (ui::dragFloat("Bright end", &high, 0.01f * std::max(high, 1e-6f), 1e-9f, 1e9f, "%.3g")) {
            view.high = std::max(high, 1e-9f);
            changed = true;
        }
    }
    if (entry.content == MapContent::Seen && entry.readsMap)
        ImGui::TextWrapped("%s", view.seenTexel ? "Click another patch to see from there."
                                                : "Click a patch to see from there.");
    return changed;
}

bool drawLight(const PanelContext& context) {
    ViewState& view = context.view;
    bool changed = false;
    bool automatic = !view.exposure;
    if (ui::checkbox("Automatic exposure", &automatic)) {
        view.exposure = automatic ? std::nullopt : std::optional(context.exposure);
        changed = true;
    }
    float exposure = view.exposure.value_or(context.exposure);
    {
        const ui::Disabled disabled(automatic);
        if (ui::sliderFloat("Exposure [EV]", &exposure, -kMostExposure, kMostExposure, "%.2f")) {
            view.exposure = exposure;
            changed = true;
        }
    }
    auto tone = static_cast<size_t>(view.tone);
    if (ui::combo("Tone mapping", tone, toneNames())) {
        view.tone = static_cast<ToneMap>(tone);
        changed = true;
    }
    auto filter = static_cast<size_t>(view.filter);
    if (ui::combo("Lightmap filter", filter, filterNames())) {
        view.filter = static_cast<LightmapFilter>(filter);
        changed = true;
    }
    return changed;
}

} // namespace

void drawViewPanel(const PanelContext& context) {
    ViewState& view = context.view;
    drawViews(context);
    ImGui::Separator();
    ImGui::PushItemWidth(ImGui::GetFontSize() * -11.0f);
    bool changed = drawContent(context);
    changed |= ui::checkbox("As UV texture", &view.uv);
    ImGui::SameLine();
    {
        const ui::Disabled disabled(!view.uv);
        changed |= ui::checkbox("Masked", &view.masked);
        ui::tip("Leave out what lies between charts");
    }
    changed |= drawLight(context);
    ImGui::Separator();
    if (ui::combo("Samples per pixel", view.samples, kSamples)) {
        context.preferences.samples = view.samples;
        changed = true;
    }
    ui::checkbox("VSync", &context.preferences.vsync);
    ui::sliderFloat("Size of text", &context.preferences.uiScale, 0.75f, 2.5f, "%.2f",
                    ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopItemWidth();
    if (changed) context.sceneChanged();
}

} // namespace relume
