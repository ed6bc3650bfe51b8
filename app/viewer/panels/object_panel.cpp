#include "app/viewer/panels/object_panel.h"

#include "app/viewer/edits/light_edits.h"
#include "app/viewer/edits/object_edits.h"
#include "app/viewer/panels/widgets.h"
#include "assets/model/scene_limits.h"

#include <algorithm>
#include <cmath>

#include <imgui.h>

namespace relume {
namespace {

constexpr float kScaleStep = 0.005f;  // of a scale, a pixel of a drag
constexpr float kDensityStep = 0.01f; // of a density, a pixel of a drag
constexpr float kLeastScale = 1e-4f;  // what is flat has neither volume nor a way back

void follow(const PanelContext& context, const char* label, const std::string& name, const Document* next) {
    ui::mark(label, true);
    if (next != nullptr) {
        context.edit(name, *next);
        context.sceneChanged();
    }
    if (ImGui::IsItemDeactivatedAfterEdit()) context.endEdit();
}

} // namespace

void ObjectPanel::drawAngles(const PanelContext& context, uint32_t instance, const std::string& name) {
    Document next = context.session.document();
    glm::mat4& transform = next.edits.placements[instance].transform;
    const glm::mat4 typed = turnedTo(transform, angles_);
    float off = anglesOf_ == instance ? 0.0f : 1.0f;
    for (int column = 0; column < 3; ++column)
        off = std::max(off, glm::distance(glm::normalize(typed[column]), glm::normalize(transform[column])));
    constexpr float kTyped = 1e-4f; // of a unit vector
    if (off > kTyped) angles_ = anglesOf(transform);
    anglesOf_ = instance;
    const bool changed =
        ImGui::DragFloat3("Rotation [deg]", &angles_.x, ui::kAngleStep, -360.0f, 360.0f, "%.1f");
    if (changed) {
        angles_ = typedAngles(angles_);
        transform = turnedTo(transform, angles_);
    }
    follow(context, "Rotation [deg]", "Rotation of " + name, changed ? &next : nullptr);
    ui::tip("Turn about the upright, tilt, roll");
}

void ObjectPanel::draw(const PanelContext& context, uint32_t instance) {
    const LoadedScene& scene = *context.session.scene();
    const std::string name = objectName(scene.prepared.scene, instance);
    ImGui::TextUnformatted(name.c_str());
    Document next = context.session.document();
    Placement& placement = next.edits.placements[instance];
    const float step = ui::kPlaceStep * std::max(scene.geometry.bounds.diagonal(), 1e-6f);
    glm::vec3 place(placement.transform[3]);
    bool changed = ImGui::DragFloat3("Position [m]", &place.x, step, 0.0f, 0.0f, "%.3f");
    if (changed) placement.transform[3] = glm::vec4(place, 1.0f);
    follow(context, "Position [m]", "Position of " + name, changed ? &next : nullptr);
    drawAngles(context, instance, name);
    const glm::vec3 before = scaleOf(placement.transform);
    glm::vec3 scale = before;
    const float largest = std::max({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z), kLeastScale});
    changed = ImGui::DragFloat3("Scale", &scale.x, kScaleStep * largest, 0.0f, 0.0f, "%.4g");
    for (int axis = 0; axis < 3; ++axis)
        scale[axis] = std::copysign(std::max(std::abs(scale[axis]), kLeastScale), before[axis]);
    if (changed) placement.transform = scaledTo(placement.transform, scale);
    follow(context, "Scale", "Scale of " + name, changed ? &next : nullptr);
    float& density = next.edits.densities[instance];
    changed = ImGui::DragFloat("Density", &density, kDensityStep * density, kLeastDensity, kMostDensity,
                               "%.3g", ImGuiSliderFlags_AlwaysClamp);
    follow(context, "Density", "Density of " + name, changed ? &next : nullptr);
    ui::tip("Factor on the texels per metre that an unwrap gives the object. It is saved with the scene and "
            "counts when "
            "the file is read again");
    bool hidden = placement.hidden;
    if (ui::checkbox("Hidden", &hidden)) context.perform(Action::HideObject, 0);
    ui::tip("It blocks no light, receives and sends none (H)");
}

} // namespace relume
