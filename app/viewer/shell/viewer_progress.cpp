#include "app/viewer/shell/viewer.h"

#include "app/viewer/state/views.h"

#include <algorithm>
#include <cmath>

#include <imgui.h>

namespace relume {
namespace {

using State = BakeBadge::State;

// The first two lengths are in points.
constexpr float kGrip = 6.0f;   // a hand may be so far beside the line
constexpr float kKnob = 7.0f;   // radius
constexpr float kMargin = 0.6f; // around text over the scene [heights of the font]

ImVec4 colorOf(State state) {
    switch (state) {
    case State::Stale:
        return {1.0f, 0.5f, 0.35f, 1.0f};
    case State::Refining:
        return {1.0f, 0.85f, 0.35f, 1.0f};
    case State::Converged:
        return {0.5f, 0.9f, 0.5f, 1.0f};
    default:
        return {0.8f, 0.8f, 0.8f, 1.0f};
    }
}

void drawLabel(ImDrawList& list, const ImVec2& at, const char* text, const ImVec4& color) {
    const ImVec2 size = ImGui::CalcTextSize(text);
    const float pad = 0.5f * kMargin * ImGui::GetFontSize();
    list.AddRectFilled({at.x - pad, at.y - pad}, {at.x + size.x + pad, at.y + size.y + pad},
                       ImGui::ColorConvertFloat4ToU32({0.0f, 0.0f, 0.0f, 0.6f}), pad);
    list.AddText(at, ImGui::ColorConvertFloat4ToU32(color), text);
}

} // namespace

void Viewer::followBadge(double time) {
    const double end = badge_.state == State::Converged ? convergedAt_ : time;
    BakeBadge badge = bakeBadge({.status = status_,
                                 .map = map(),
                                 .newestBake = session_->newestBake(),
                                 .edit = newestEdit_,
                                 .seconds = std::max(end - editedAt_, 0.0)});
    // An edit may be answered between two looks: it had converged before, and has again.
    const uint64_t converged = badge.state == State::Converged ? session_->newestBake() : 0;
    if (badge.state != badge_.state || (converged != told_.converged && converged != 0)) {
        if (badge.state == State::Converged) convergedAt_ = time;
        tell("badge", badgeName(badge.state));
        pacer_.input();
    }
    told_.converged = converged;
    badge_ = std::move(badge);
}

// Notes an edit. Light that had converged becomes the reference that the edit is compared with.
void Viewer::beforeEdit(const std::string& name, const std::string& underWay) {
    if (badge_.state == State::Converged && !ownReference_ && session_->scene() != nullptr)
        pane_.storeReference(look());
    if (name != underWay) editedAt_ = now();
    newestEdit_ = name;
}

void Viewer::performWipe(Action action) {
    if (session_->scene() == nullptr) return note("there is no scene to compare", true);
    if (action == Action::StoreReference) {
        if (!pane_.storeReference(look())) return note("only light can be stored: choose the view Lit", true);
        ownReference_ = true;
        note("stored as B");
    } else {
        view_.wipe = !view_.wipe;
        if (view_.wipe && !pane_.hasReference())
            note(
                "nothing to compare with yet: B is the last light that had converged before an edit, or what "
                "Shift+B stores");
    }
    changeScene();
}

bool Viewer::showsWipe() const {
    const ViewEntry& entry = viewEntries()[view_.view];
    return view_.wipe && pane_.hasReference() && !view_.uv && readsLightmap(entry.view) &&
           showsLight(entry.view) && entry.content == MapContent::Light && !entry.voxels;
}

bool Viewer::overWipe(const glm::dvec2& at) const {
    const float line = area_.corner.x + view_.wipeAt * area_.size.x;
    return showsWipe() && std::abs(static_cast<float>(at.x) - line) <= kGrip * scale_;
}

void Viewer::dragWipe(const glm::dvec2& at) {
    const float share = (static_cast<float>(at.x) - area_.corner.x) / std::max(area_.size.x, 1.0f);
    view_.wipeAt = std::clamp(share, 0.0f, 1.0f);
    changeScene();
}

// Draws the line of the wipe over the picture, and how far the light is.
void Viewer::drawProgress() {
    if (session_->scene() == nullptr) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const glm::vec2 low = area_.corner, high = area_.corner + area_.size;
    const float margin = kMargin * ImGui::GetFontSize();
    list.PushClipRect({low.x, low.y}, {high.x, high.y});
    if (showsWipe()) {
        const float x = low.x + view_.wipeAt * area_.size.x, middle = 0.5f * (low.y + high.y);
        const ui::ItemLog::Scope scope(items_, "Wipe");
        items_.add("Line", glm::ivec2(glm::round(glm::vec2(x, middle))));
        const ImU32 dark = ImGui::ColorConvertFloat4ToU32({0.0f, 0.0f, 0.0f, 0.6f});
        const ImU32 light = ImGui::ColorConvertFloat4ToU32({1.0f, 1.0f, 1.0f, 1.0f});
        list.AddLine({x, low.y}, {x, high.y}, dark, 3.0f * scale_);
        list.AddLine({x, low.y}, {x, high.y}, light, scale_);
        list.AddCircleFilled({x, middle}, kKnob * scale_, light);
        const char* left = ownReference_ ? "B: stored" : "B: before";
        const ImVec4 white(1.0f, 1.0f, 1.0f, 1.0f);
        const float top = low.y + margin;
        drawLabel(list, {x - ImGui::CalcTextSize(left).x - 2.0f * margin, top}, left, white);
        drawLabel(list, {x + 2.0f * margin, top}, "A: now", white);
    }
    if (!hidden_ && !badge_.text.empty()) {
        const ImVec2 size = ImGui::CalcTextSize(badge_.text.c_str());
        drawLabel(list, {high.x - size.x - 2.0f * margin, high.y - size.y - 2.0f * margin},
                  badge_.text.c_str(), colorOf(badge_.state));
    }
    list.PopClipRect();
}

} // namespace relume
