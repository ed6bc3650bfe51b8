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

void drawBadge(const BakeBadge& badge, const std::string& furnished, const PictureArea& area) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const glm::vec2 low = area.corner, high = area.corner + area.size;
    const float margin = 2.0f * labelMargin();
    list.PushClipRect({low.x, low.y}, {high.x, high.y});
    float bottom = high.y - margin;
    const auto draw = [&](const std::string& text, const glm::vec4& colour) {
        if (text.empty()) return;
        const ImVec2 size = ImGui::CalcTextSize(text.c_str());
        bottom -= size.y;
        drawLabel({high.x - size.x - margin, bottom}, text.c_str(), colour);
        bottom -= margin;
    };
    draw(badge.text, colorOf(badge.state));
    draw(furnished, {0.8f, 0.8f, 0.8f, 1.0f});
    list.PopClipRect();
}

} // namespace relume
