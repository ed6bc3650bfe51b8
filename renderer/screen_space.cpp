#include "renderer/screen_space.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

bool isFlat(const ViewCamera& camera) {
    return camera.halfHeight > 0.0f;
}

glm::vec3 upward(const ViewCamera& camera) {
    return glm::cross(right(camera), forward(camera));
}

// Returns half of the picture's height: for all depths, or at a depth of 1.
float halfHeight(const ViewCamera& camera) {
    return isFlat(camera) ? camera.halfHeight : std::tan(0.5f * camera.yfov);
}

// Returns how far a position is to the right of the eye, above it and before it [m].
glm::vec3 inView(const ViewCamera& camera, const glm::vec3& position) {
    const glm::vec3 way = position - camera.eye;
    return {glm::dot(way, right(camera)), glm::dot(way, upward(camera)), glm::dot(way, forward(camera))};
}

glm::vec2 onScreen(const ScreenView& view, const glm::vec3& inView) {
    const float depth = isFlat(view.camera) ? 1.0f : inView.z;
    const float scale = 0.5f * view.size.y / (halfHeight(view.camera) * depth);
    return 0.5f * view.size + scale * glm::vec2(inView.x, -inView.y);
}

} // namespace

ScreenRay rayThrough(const ScreenView& view, const glm::vec2& point) {
    const glm::vec2 off = (point - 0.5f * view.size) * (2.0f * halfHeight(view.camera) / view.size.y);
    const glm::vec3 side = off.x * right(view.camera) - off.y * upward(view.camera);
    if (isFlat(view.camera)) return {view.camera.eye + side, forward(view.camera)};
    return {view.camera.eye, glm::normalize(forward(view.camera) + side)};
}

std::optional<glm::vec2> project(const ScreenView& view, const glm::vec3& position) {
    const glm::vec3 place = inView(view.camera, position);
    if (!(place.z >= view.camera.znear)) return std::nullopt;
    return onScreen(view, place);
}

std::optional<std::pair<glm::vec2, glm::vec2>> projectLine(const ScreenView& view, const glm::vec3& from,
                                                           const glm::vec3& to) {
    glm::vec3 a = inView(view.camera, from), b = inView(view.camera, to);
    const float nearest = view.camera.znear;
    if (!(std::max(a.z, b.z) >= nearest)) return std::nullopt;
    if (a.z < nearest) a = glm::mix(a, b, (nearest - a.z) / (b.z - a.z));
    if (b.z < nearest) b = glm::mix(b, a, (nearest - b.z) / (a.z - b.z));
    return std::pair(onScreen(view, a), onScreen(view, b));
}

float lengthOnScreen(const ScreenView& view, const glm::vec3& position) {
    const float depth =
        isFlat(view.camera) ? 1.0f : std::max(inView(view.camera, position).z, view.camera.znear);
    return 2.0f * halfHeight(view.camera) * depth / view.size.y;
}

glm::vec3 towardsEye(const ViewCamera& camera, const glm::vec3& position) {
    const glm::vec3 way = camera.eye - position;
    const float length = glm::length(way);
    return isFlat(camera) || !(length > 0.0f) ? -forward(camera) : way / length;
}

} // namespace relume
