#include "app/viewer/picture/picture_labels.h"

#include <imgui.h>

namespace relume {
namespace {

constexpr float kLabelMargin = 0.6f; // [heights of the font]

glm::vec4 colorOf(BakeBadge::State state) {
    switch (state) {
    case BakeBadge::State::Stale:
        return {1.0f, 0.5f, 0.35f, 1.0f};
    case BakeBadge::State::Refining:
        return {1.0f, 0.85f, 0.35f, 1.0f};
    case BakeBadge::State::Converged:
        return {0.5f, 0.9f, 0.5f, 1.0f};
    default:
        return {0.8f, 0.8f, 0.8f, 1.0f};
    }
}

} // namespace

float labelMargin() {
    return kLabelMargin * ImGui::GetFontSize();
}

float labelWidth(const char* text) {
    return ImGui::CalcTextSize(text).x;
}

void drawLabel(const glm::vec2& at, const char* text, const glm::vec4& color) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::CalcTextSize(text);
    const float pad = 0.5f * labelMargin();
    list.AddRectFilled({at.x - pad, at.y - pad}, {at.x + size.x + pad, at.y + size.y + pad},
                       ImGui::ColorConvertFloat4ToU32({0.0f, 0.0f, 0.0f, 0.6f}), pad);
    list.AddText({at.x, at.y}, ImGui::ColorConvertFloat4ToU32({color.r, color.g, color.b, color.a}), text);
}

void drawBadge(const BakeBadge& badge, const PictureArea& area) {
    if (badge.text.empty()) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const glm::vec2 low = area.corner, high = area.corner + area.size;
    const ImVec2 size = ImGui::CalcTextSize(badge.text.c_str());
    const float margin = 2.0f * labelMargin();
    list.PushClipRect({low.x, low.y}, {high.x, high.y});
    drawLabel({high.x - size.x - margin, high.y - size.y - margin}, badge.text.c_str(), colorOf(badge.state));
    list.PopClipRect();
}

} // namespace relume
