#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "renderer/screen_space.h"

namespace relume {

enum class GizmoMode : uint8_t { Translate, Rotate };

/// What of a gizmo is taken hold of: an axis of the world (to rotate: a ring about it), a plane of two, or
/// all directions of the picture (to rotate: about the direction of view).
enum class GizmoHandle : uint8_t { None, X, Y, Z, YZ, ZX, XY, Screen };

/// A gizmo of one size on every picture, to move or turn what stands at `origin`.
struct GizmoPlace {
    ScreenView view;        // its size in points
    glm::vec3 origin{0.0f}; // [m]
    GizmoMode mode = GizmoMode::Translate;
};

struct GizmoShape {
    GizmoHandle handle = GizmoHandle::None;
    std::vector<glm::vec2> points; // [points]
    bool filled = false;           // a polygon, else a line through them
};
/// What is to be drawn, from back to front. Empty: behind the eye.
std::vector<GizmoShape> gizmoShapes(const GizmoPlace& place);
/// A point to take hold of it.
glm::vec2 gripOf(const GizmoShape& shape);
/// As displayed.
glm::vec3 gizmoColor(GizmoHandle handle);
/// What is near enough to a point to be taken hold of.
GizmoHandle gizmoAt(const GizmoPlace& place, const glm::vec2& point);

/// A drag of a gizmo. All is counted from where it began, so nothing adds up on the way.
class GizmoDrag {
public:
    /// handle: not None; transform: of what is dragged, to world: it is turned about the place's origin.
    GizmoDrag(const GizmoPlace& place, GizmoHandle handle, const glm::mat4& transform,
              const glm::vec2& point);
    /// Goes on along or about another one, from the same beginning.
    void constrain(GizmoHandle handle) { handle_ = handle; }
    GizmoHandle handle() const { return handle_; }
    GizmoMode mode() const { return place_.mode; }
    const glm::mat4& begin() const { return transform_; }
    /// The transform with the cursor at this point. steps: turns come in 15 degrees.
    glm::mat4 moved(const glm::vec2& point, bool steps = false) const;

private:
    glm::vec3 translation(const glm::vec2& point) const;
    float rotation(const glm::vec3& axis, const glm::vec2& point) const;

    GizmoPlace place_;
    GizmoHandle handle_;
    glm::mat4 transform_;
    glm::vec2 from_;
};

} // namespace relume
