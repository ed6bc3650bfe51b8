#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "renderer/screen_space.h"

namespace relume {

enum class GizmoMode : uint8_t { Translate, Rotate };

/// Names the part of a gizmo that is taken hold of: an axis of the world (to rotate: a ring about it), a
/// plane of two, or all directions of the picture (to rotate: about the direction of view).
enum class GizmoHandle : uint8_t { None, X, Y, Z, YZ, ZX, XY, Screen };

/// Places a gizmo of one size on every picture, to move or turn what stands at `origin`.
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
/// Returns what is to be drawn, from back to front; nothing where the gizmo is behind the eye.
std::vector<GizmoShape> gizmoShapes(const GizmoPlace& place);
/// Returns a point at which the shape can be taken hold of.
glm::vec2 gripOf(const GizmoShape& shape);
/// Returns the colour of a handle, as displayed.
glm::vec3 gizmoColor(GizmoHandle handle);
/// Returns the handle that is near enough to a point to be taken hold of.
GizmoHandle gizmoAt(const GizmoPlace& place, const glm::vec2& point);

/// Follows a drag of a gizmo. All is counted from where it began, so nothing adds up on the way.
class GizmoDrag {
public:
    /// Begins a drag of a handle, not None. `transform` is that of what is dragged, to world; it is turned
    /// about the place's origin.
    GizmoDrag(const GizmoPlace& place, GizmoHandle handle, const glm::mat4& transform,
              const glm::vec2& point);
    /// Goes on along or about another handle, from the same beginning.
    void constrain(GizmoHandle handle) { handle_ = handle; }
    GizmoHandle handle() const { return handle_; }
    GizmoMode mode() const { return place_.mode; }
    const glm::mat4& begin() const { return transform_; }
    /// Returns the transform with the cursor at this point. With `steps`, turns come in steps of 15 degrees.
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
