#pragma once

#include <glm/glm.hpp>

#include "renderer/camera.h"
#include "renderer/gizmo.h"

namespace relume {

/// A step that a key moves or turns something by.
struct Nudge {
    GizmoMode mode = GizmoMode::Translate;
    int direction = 1;        // 1, 2, 3 along the picture's right, up and forward, less than 0 against it
    float diagonal = 0;       // of the scene [m], of which a step is a share
    glm::vec3 pivot{0.0f};    // [m], about which it is turned
    const ViewCamera& camera; // the world's axes that are nearest to the picture's are taken
};

/// Returns the transform after a step.
glm::mat4 nudged(const glm::mat4& transform, const Nudge& nudge);

} // namespace relume
