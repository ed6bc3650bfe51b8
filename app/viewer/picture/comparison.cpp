#include "app/viewer/picture/comparison.h"

#include "app/viewer/picture/picture_labels.h"
#include "app/viewer/state/view_actions.h"

#include <algorithm>
#include <cmath>

#include <imgui.h>

namespace relume {
namespace {

// These are in points.
constexpr float kGrip = 6.0f; // a hand may be so far beside the line
constexpr float kKnob = 7.0f; // radius

} // namespace

void Comparison::beforeEdit(bool converged) {
    if (converged && !stored_ && picture_.pane().hasScene()) picture_.pane().storeReference(picture_.look());
}

void Comparison::perform(Action action) {
    if (!picture_.pane().hasScene()) return feedback_.note("there is no scene to compare", true);
    if (action == Action::StoreReference) {
        if (!picture_.pane().storeReference(picture_.look()))
            return feedback_.note("only light can be stored: choose the view Lit", true);
        stored_ = true;
        feedback_.note("stored as B");
    } else {
        bool& wipe = picture_.state().wipe;
        wipe = !wipe;
        if (wipe && !picture_.pane().hasReference())
            feedback_.note(
                "nothing to compare with yet: B is the last light that had converged before an edit, or what "
                "Shift+B stores");
    }
    feedback_.sceneChanged();
}

bool Comparison::shown() const {
    const ViewState& view = picture_.state();
    return view.wipe && picture_.pane().hasReference() && comparesLight(view);
}

glm::vec2 Comparison::grip() const {
    const PictureArea& area = picture_.area();
    return {area.corner.x + picture_.state().wipeAt * area.size.x, area.corner.y + 0.5f * area.size.y};
}

bool Comparison::press(const glm::dvec2& at) {
    held_ = shown() && std::abs(static_cast<float>(at.x) - grip().x) <= kGrip * picture_.scale();
    return held_;
}

void Comparison::drag(const glm::dvec2& at) {
    const PictureArea& area = picture_.area();
    const float share = (static_cast<float>(at.x) - area.corner.x) / std::max(area.size.x, 1.0f);
    picture_.state().wipeAt = std::clamp(share, 0.0f, 1.0f);
    feedback_.sceneChanged();
}

void Comparison::draw() const {
    if (!shown()) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const PictureArea& area = picture_.area();
    const glm::vec2 low = area.corner, high = area.corner + area.size, middle = grip();
    list.PushClipRect({low.x, low.y}, {high.x, high.y});
    const ImU32 dark = ImGui::ColorConvertFloat4ToU32({0.0f, 0.0f, 0.0f, 0.6f});
    const ImU32 light = ImGui::ColorConvertFloat4ToU32({1.0f, 1.0f, 1.0f, 1.0f});
    const float scale = picture_.scale();
    list.AddLine({middle.x, low.y}, {middle.x, high.y}, dark, 3.0f * scale);
    list.AddLine({middle.x, low.y}, {middle.x, high.y}, light, scale);
    list.AddCircleFilled({middle.x, middle.y}, kKnob * scale, light);
    const char* left = stored_ ? "B: stored" : "B: before";
    const glm::vec4 white(1.0f);
    const float margin = labelMargin(), top = low.y + margin;
    drawLabel({middle.x - labelWidth(left) - 2.0f * margin, top}, left, white);
    drawLabel({middle.x + 2.0f * margin, top}, "A: now", white);
    list.PopClipRect();
}

} // namespace relume
