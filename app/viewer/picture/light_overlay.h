#pragma once

#include <optional>

#include "app/viewer/edits/light_edits.h"
#include "app/viewer/state/view_state.h"
#include "renderer/gizmo.h"

namespace relume {

/// The data for what is drawn over the picture of a scene: an icon for each light without geometry, and the
/// gizmo of the selected one or of the selected object.
struct LightStage {
    const SceneEdits& edits;
    const LightMix& mix;
    const ViewState& view;
    ScreenView screen;                    // in points, like all below
    std::optional<glm::vec3> object = {}; // where the gizmo of the selected object is [m]; none: it has none
    float scale = 1.0f;                   // screen coordinates in a point
    std::optional<GizmoMode> mode = {};   // in place of the view's
};

/// Returns the selected light without geometry, or nullptr where none is selected.
const Light* selectedLamp(const LightStage& stage);
/// Returns the gizmo of the selected light or object, or nothing where nothing can be dragged.
std::optional<GizmoPlace> gizmoOf(const LightStage& stage);
/// Returns the light whose icon is nearest to a point, or nothing where none is in reach.
std::optional<LightKey> iconAt(const LightStage& stage, const glm::vec2& point);
/// Draws icons and gizmo within a frame of Dear ImGui, behind its windows. `corner` is the picture's in the
/// window; the handle `held` is highlighted.
void drawLights(const LightStage& stage, const glm::vec2& corner, GizmoHandle held);

} // namespace relume
