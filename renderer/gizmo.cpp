#include "renderer/gizmo.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

// These are all in points of the picture.
constexpr float kLength = 90, kRing = 80, kScreenRing = 96, kHead = 12, kCentre = 8;
constexpr float kPlaneFrom = 24, kPlaneTo = 44; // of the squares between two axes
constexpr float kHandReach = 7;                 // that a hand is off
constexpr int kRingParts = 64;
// This is the sine of the angle to the direction of view below which an axis, or a plane seen from its edge,
// says nothing about depth: 6 degrees.
constexpr float kEdgeOn = 0.1f;
// No drag goes further than so many distances to the eye, where an axis runs to its vanishing point.
constexpr float kFarthest = 1e3f;
constexpr float kTurnStep = std::numbers::pi_v<float> / 12.0f; // [rad]

int axisOf(GizmoHandle handle) {
    switch (handle) {
    case GizmoHandle::X:
    case GizmoHandle::YZ:
        return 0;
    case GizmoHandle::Y:
    case GizmoHandle::ZX:
        return 1;
    case GizmoHandle::Z:
    case GizmoHandle::XY:
        return 2;
    default:
        return -1;
    }
}

bool isPlane(GizmoHandle handle) {
    return handle == GizmoHandle::YZ || handle == GizmoHandle::ZX || handle == GizmoHandle::XY;
}

glm::vec3 unit(int axis) {
    glm::vec3 direction(0.0f);
    direction[axis] = 1.0f;
    return direction;
}

// Returns where a ray meets a plane, or none where it runs beside the plane or away from it.
std::optional<glm::vec3> meet(const ScreenRay& ray, const glm::vec3& origin, const glm::vec3& normal) {
    const float slope = glm::dot(ray.direction, normal);
    if (std::abs(slope) < 1e-6f) return std::nullopt;
    const float distance = glm::dot(origin - ray.origin, normal) / slope;
    if (!(distance > 0.0f)) return std::nullopt;
    return ray.at(distance);
}

float distanceToLine(const glm::vec2& point, const glm::vec2& a, const glm::vec2& b) {
    const glm::vec2 way = b - a;
    const float length = glm::dot(way, way);
    const float share = length > 0.0f ? std::clamp(glm::dot(point - a, way) / length, 0.0f, 1.0f) : 0.0f;
    return glm::distance(point, a + share * way);
}

bool inside(const std::vector<glm::vec2>& polygon, const glm::vec2& point) {
    bool within = false;
    for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const glm::vec2 &a = polygon[i], &b = polygon[j];
        if ((a.y > point.y) != (b.y > point.y) && point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x)
            within = !within;
    }
    return within;
}

/// Makes shapes in a world where 1 is one point of the picture.
class Builder {
public:
    explicit Builder(const GizmoPlace& place)
        : place_(place), scale_(lengthOnScreen(place.view, place.origin)),
          eye_(towardsEye(place.view.camera, place.origin)) {}

    void add(GizmoHandle handle, const std::vector<glm::vec3>& offsets, bool filled) {
        GizmoShape shape{.handle = handle, .points = {}, .filled = filled};
        for (const glm::vec3& offset : offsets) {
            const std::optional<glm::vec2> point = project(place_.view, place_.origin + scale_ * offset);
            if (!point) return; // larger than its distance: nothing that one could hold
            shape.points.push_back(*point);
        }
        if (shape.points.size() > 1) shapes.push_back(std::move(shape));
    }

    void addAxis(GizmoHandle handle) {
        const glm::vec3 axis = unit(axisOf(handle));
        if (glm::length(glm::cross(axis, eye_)) < kEdgeOn) return;
        add(handle, {kCentre * axis, kLength * axis}, false);
        const glm::vec3 side = 0.35f * kHead * glm::normalize(glm::cross(axis, eye_));
        add(handle, {kLength * axis - side, (kLength + kHead) * axis, kLength * axis + side}, true);
    }

    void addPlane(GizmoHandle handle) {
        const int axis = axisOf(handle);
        if (std::abs(eye_[axis]) < kEdgeOn) return;
        const glm::vec3 a = unit((axis + 1) % 3), b = unit((axis + 2) % 3);
        add(handle,
            {kPlaneFrom * (a + b), kPlaneTo * a + kPlaneFrom * b, kPlaneTo * (a + b),
             kPlaneFrom * a + kPlaneTo * b},
            true);
    }

    // Adds the half of a ring that is towards the eye, or all of it where it is seen face on.
    void addRing(GizmoHandle handle, const glm::vec3& axis, float radius) {
        const glm::vec3 along = std::abs(axis.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
        const glm::vec3 a = glm::normalize(glm::cross(axis, along)), b = glm::cross(axis, a);
        std::vector<glm::vec3> part;
        const bool whole = std::abs(glm::dot(axis, eye_)) > 1.0f - kEdgeOn;
        const float first =
            std::atan2(glm::dot(b, eye_), glm::dot(a, eye_)) - 0.5f * std::numbers::pi_v<float>;
        const float arc = whole ? 2.0f : 1.0f;
        for (int i = 0; i <= kRingParts; ++i) {
            const float angle = first + arc * std::numbers::pi_v<float> * static_cast<float>(i) / kRingParts;
            part.push_back(radius * (std::cos(angle) * a + std::sin(angle) * b));
        }
        add(handle, part, false);
    }

    const glm::vec3& eye() const { return eye_; }
    std::vector<GizmoShape> shapes;

private:
    const GizmoPlace& place_;
    float scale_; // [m]
    glm::vec3 eye_;
};

} // namespace

std::vector<GizmoShape> gizmoShapes(const GizmoPlace& place) {
    Builder builder(place);
    constexpr std::array kAxes = {GizmoHandle::X, GizmoHandle::Y, GizmoHandle::Z};
    if (place.mode == GizmoMode::Rotate) {
        const glm::vec3 towards = -forward(place.view.camera);
        builder.addRing(GizmoHandle::Screen, towards, kScreenRing);
        for (const GizmoHandle handle : kAxes)
            builder.addRing(handle, unit(axisOf(handle)), kRing);
        return std::move(builder.shapes);
    }
    for (const GizmoHandle handle : {GizmoHandle::YZ, GizmoHandle::ZX, GizmoHandle::XY})
        builder.addPlane(handle);
    for (const GizmoHandle handle : kAxes)
        builder.addAxis(handle);
    builder.addRing(GizmoHandle::Screen, -forward(place.view.camera), kCentre);
    return std::move(builder.shapes);
}

glm::vec2 gripOf(const GizmoShape& shape) {
    const bool ring = !shape.filled && shape.points.size() > 2;
    if (ring) return shape.points[shape.points.size() / 2]; // its front
    glm::vec2 sum(0.0f);
    for (const glm::vec2& point : shape.points)
        sum += point;
    return sum / static_cast<float>(shape.points.size());
}

glm::vec3 gizmoColor(GizmoHandle handle) {
    constexpr std::array<glm::vec3, 3> kColors = {
        {{0.9f, 0.25f, 0.25f}, {0.35f, 0.8f, 0.25f}, {0.3f, 0.5f, 1.0f}}};
    const int axis = axisOf(handle);
    return axis < 0 ? glm::vec3(0.85f) : kColors[static_cast<size_t>(axis)];
}

GizmoHandle gizmoAt(const GizmoPlace& place, const glm::vec2& point) {
    GizmoHandle nearest = GizmoHandle::None;
    float least = kHandReach;
    for (const GizmoShape& shape : gizmoShapes(place)) {
        float distance = std::numeric_limits<float>::max();
        for (size_t i = 0; i + 1 < shape.points.size(); ++i)
            distance = std::min(distance, distanceToLine(point, shape.points[i], shape.points[i + 1]));
        // Within an area all is as near as can be; so small a ring is an area up to its middle.
        const bool area =
            shape.filled || (place.mode == GizmoMode::Translate && shape.handle == GizmoHandle::Screen);
        if (area && inside(shape.points, point)) distance = 0.0f;
        if (distance > least) continue;
        least = distance;
        nearest = shape.handle;
    }
    return nearest;
}

GizmoDrag::GizmoDrag(const GizmoPlace& place, GizmoHandle handle, const glm::mat4& transform,
                     const glm::vec2& point)
    : place_(place), handle_(handle), transform_(transform), from_(point) {
    ASSERT(handle != GizmoHandle::None);
}

glm::vec3 GizmoDrag::translation(const glm::vec2& point) const {
    const ViewCamera& camera = place_.view.camera;
    const glm::vec3 eye = towardsEye(camera, place_.origin);
    const int axis = axisOf(handle_);
    glm::vec3 normal = -forward(camera);
    bool flat = false; // says nothing about depth
    if (isPlane(handle_)) {
        normal = unit(axis);
        flat = std::abs(eye[axis]) < kEdgeOn;
    } else if (axis >= 0) {
        // This is the plane through the axis that faces the eye most.
        const glm::vec3 side = glm::cross(unit(axis), eye);
        flat = glm::length(side) < kEdgeOn;
        if (!flat) normal = glm::normalize(glm::cross(side, unit(axis)));
    }
    if (flat) normal = -forward(camera);
    const std::optional<glm::vec3> from = meet(rayThrough(place_.view, from_), place_.origin, normal);
    const std::optional<glm::vec3> to = meet(rayThrough(place_.view, point), place_.origin, normal);
    if (!from || !to) return glm::vec3(0.0f);
    glm::vec3 move = *to - *from;
    if (flat && !isPlane(handle_)) // it points at the eye: up is away from it
        move = unit(axis) * (from_.y - point.y) * lengthOnScreen(place_.view, place_.origin) *
               (eye[axis] > 0.0f ? -1.0f : 1.0f);
    else if (isPlane(handle_))
        move[axis] = 0.0f;
    else if (axis >= 0)
        move = unit(axis) * move[axis];
    const float length = glm::length(move), most = kFarthest * glm::distance(camera.eye, place_.origin);
    return length > most ? move * (most / length) : move;
}

// Returns the turn [rad], counter-clockwise about the axis.
float GizmoDrag::rotation(const glm::vec3& axis, const glm::vec2& point) const {
    const glm::vec3 eye = towardsEye(place_.view.camera, place_.origin);
    const std::optional<glm::vec3> from = meet(rayThrough(place_.view, from_), place_.origin, axis);
    const std::optional<glm::vec3> to = meet(rayThrough(place_.view, point), place_.origin, axis);
    if (std::abs(glm::dot(axis, eye)) >= kEdgeOn && from && to) {
        const glm::vec3 a = *from - place_.origin, b = *to - place_.origin;
        return std::atan2(glm::dot(axis, glm::cross(a, b)), glm::dot(a, b));
    }
    // Seen from its edge the ring is a line: its front goes along with the cursor.
    const glm::vec3 front = glm::cross(axis, eye);
    const glm::vec2 on(glm::dot(front, right(place_.view.camera)),
                       -glm::dot(front, glm::cross(right(place_.view.camera), forward(place_.view.camera))));
    const float length = glm::length(on);
    return length > 0.0f ? glm::dot(point - from_, on / length) / kRing : 0.0f;
}

glm::mat4 GizmoDrag::moved(const glm::vec2& point, bool steps) const {
    glm::mat4 result = transform_;
    if (place_.mode == GizmoMode::Translate) {
        result[3] += glm::vec4(translation(point), 0.0f);
        return result;
    }
    const int index = axisOf(handle_);
    const glm::vec3 axis = index < 0 ? -forward(place_.view.camera) : unit(index);
    float angle = rotation(axis, point);
    if (steps) angle = kTurnStep * std::round(angle / kTurnStep);
    const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), angle, axis);
    const glm::vec3 arm = glm::vec3(transform_[3]) - place_.origin;
    result = turn * transform_;
    result[3] = glm::vec4(place_.origin + glm::mat3(turn) * arm, 1.0f);
    return result;
}

} // namespace relume
