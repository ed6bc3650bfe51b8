#include "app/viewer/picture/light_overlay.h"

#include "renderer/light_outline.h"

#include <algorithm>
#include <limits>

#include <imgui.h>

namespace relume {
namespace {

// These lengths are in points.
constexpr float kIcon = 13.0f;       // radius
constexpr float kClickReach = 12.0f; // a click may be so far off
constexpr float kThin = 1.3f, kThick = 2.2f, kShade = 2.0f;
constexpr glm::vec3 kSelected(1.0f, 0.55f, 0.1f), kHeld(1.0f, 0.9f, 0.3f), kDark(0.45f); // as displayed
constexpr float kWhitened = 0.5f; // share of white in an icon's colour: a deep blue would not be seen

ImU32 packed(const glm::vec3& color, float opacity) {
    return ImGui::ColorConvertFloat4ToU32({color.r, color.g, color.b, opacity});
}

/// Draws with points as its unit.
class Pen {
public:
    Pen(const LightStage& stage, const glm::vec2& corner) : scale_(stage.scale), corner_(corner) {}

    ImVec2 at(const glm::vec2& point) const {
        return {corner_.x + scale_ * point.x, corner_.y + scale_ * point.y};
    }
    void line(const glm::vec2& from, const glm::vec2& to, ImU32 color, float width) const {
        ImGui::GetBackgroundDrawList()->AddLine(at(from), at(to), color, scale_ * width);
    }
    void line(const std::vector<ImVec2>& points, ImU32 color, float width) const {
        ImGui::GetBackgroundDrawList()->AddPolyline(points.data(), static_cast<int>(points.size()), color,
                                                    ImDrawFlags_None, scale_ * width);
    }

private:
    float scale_;
    glm::vec2 corner_;
};

glm::vec3 iconColor(const LightStage& stage, const LightKey& key, const Light& light) {
    if (stage.view.light == key) return kSelected;
    if (!stage.mix.shines(key)) return kDark;
    const float most = std::max({light.color.r, light.color.g, light.color.b, 1e-6f});
    return glm::mix(light.color / most, glm::vec3(1.0f), kWhitened);
}

void drawIcon(const LightStage& stage, const Pen& pen, const LightKey& key, const Light& light) {
    const ViewCamera& camera = stage.screen.camera;
    const glm::vec3 side = right(camera);
    const OutlineDesc desc{.right = side,
                           .up = glm::cross(side, forward(camera)),
                           .size = kIcon * lengthOnScreen(stage.screen, glm::vec3(light.transform[3]))};
    const std::vector<OutlineSegment> segments = lightOutline(light, desc);
    const float width = stage.view.light == key ? kThick : kThin;
    // There is a dark line below each, so that they show before anything.
    for (const bool shade : {true, false}) {
        const ImU32 color =
            shade ? packed(glm::vec3(0.0f), 0.5f) : packed(iconColor(stage, key, light), 1.0f);
        for (const OutlineSegment& segment : segments)
            if (const auto line = projectLine(stage.screen, segment.from, segment.to))
                pen.line(line->first, line->second, color, shade ? width + kShade : width);
    }
}

void drawGizmo(const LightStage& stage, const Pen& pen, GizmoHandle held) {
    const std::optional<GizmoPlace> place = gizmoOf(stage);
    if (!place) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const GizmoShape& shape : gizmoShapes(*place)) {
        std::vector<ImVec2> points;
        for (const glm::vec2& point : shape.points)
            points.push_back(pen.at(point));
        const bool lit = shape.handle == held;
        const glm::vec3 color = lit ? kHeld : gizmoColor(shape.handle);
        const auto count = static_cast<int>(points.size());
        if (shape.filled) {
            const bool area = count > 3; // planes let the scene through, arrow heads do not
            list.AddConvexPolyFilled(points.data(), count, packed(color, area ? 0.45f : 1.0f));
        } else {
            pen.line(points, packed(glm::vec3(0.0f), 0.5f), kThick + kShade);
            pen.line(points, packed(color, 1.0f), kThick);
        }
    }
}

} // namespace

const Light* selectedLamp(const LightStage& stage) {
    const std::optional<LightKey>& key = stage.view.light;
    const bool lamp = key && key->kind == LightKey::Kind::Lamp && key->index < stage.edits.lights.size();
    return lamp ? &stage.edits.lights[key->index] : nullptr;
}

std::optional<GizmoPlace> gizmoOf(const LightStage& stage) {
    const Light* light = selectedLamp(stage);
    if (light == nullptr && !stage.object) return std::nullopt;
    const glm::vec3 origin = light != nullptr ? glm::vec3(light->transform[3]) : *stage.object;
    return GizmoPlace{stage.screen, origin, stage.mode.value_or(stage.view.gizmo)};
}

std::optional<LightKey> iconAt(const LightStage& stage, const glm::vec2& point) {
    std::optional<LightKey> found;
    float least = kClickReach;
    for (uint32_t i = 0; i < stage.edits.lights.size() && stage.view.lightIcons; ++i) {
        const auto place = project(stage.screen, glm::vec3(stage.edits.lights[i].transform[3]));
        const float distance = place ? glm::distance(*place, point) : std::numeric_limits<float>::max();
        if (distance > least) continue;
        least = distance;
        found = LightKey{LightKey::Kind::Lamp, i, 0};
    }
    return found;
}

void drawLights(const LightStage& stage, const glm::vec2& corner, GizmoHandle held) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const Pen pen(stage, corner);
    list.PushClipRect(pen.at(glm::vec2(0.0f)), pen.at(stage.screen.size));
    for (uint32_t i = 0; i < stage.edits.lights.size() && stage.view.lightIcons; ++i)
        drawIcon(stage, pen, {LightKey::Kind::Lamp, i, 0}, stage.edits.lights[i]);
    drawGizmo(stage, pen, held);
    list.PopClipRect();
}

} // namespace relume
