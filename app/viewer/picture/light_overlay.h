#pragma once

#include <optional>

#include "app/viewer/edits/light_edits.h"
#include "app/viewer/state/view_state.h"
#include "renderer/gizmo.h"

namespace relume {

/// Lights over the picture of a scene: an icon for each that has no geometry; and the gizmo of the selected
/// one, or of the selected object.
struct LightStage {
    const SceneEdits& edits;
    const LightMix& mix;
    const ViewState& view;
    ScreenView screen;                    // in points, as all below
    std::optional<glm::vec3> object = {}; // where the gizmo of the selected object is [m]; none: it has none
    float scale = 1.0f;                   // screen coordinates in a point
};

/// nullptr: no light without geometry is selected.
const Light* selectedLamp(const LightStage& stage);
/// The gizmo of the selected light or object; none: nothing to be dragged.
std::optional<GizmoPlace> gizmoOf(const LightStage& stage);
/// The light whose icon is at a point, the nearest to it.
std::optional<LightKey> iconAt(const LightStage& stage, const glm::vec2& point);
/// Within a frame of Dear ImGui, behind its windows. corner: of the picture in the window; held: highlighted.
void drawLights(const LightStage& stage, const glm::vec2& corner, GizmoHandle held);

} // namespace relume
