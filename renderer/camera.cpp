#include "renderer/camera.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

constexpr float kPoleMargin = 0.01f; // [rad] to the poles, where yaw has no meaning
// Things nearer than this share of the scene's diagonal are cut off. Depth is as good with any share, see
// projectionMatrix.
constexpr float kNearShare = 1e-4f;
constexpr glm::vec3 kUpright(0.0f, 1.0f, 0.0f);

glm::vec3 rotated(const glm::vec3& v, float angle, const glm::vec3& axis) {
    return glm::vec3(glm::rotate(glm::mat4(1.0f), angle, axis) * glm::vec4(v, 0.0f));
}

// Returns `offset` turned about `up` and then towards it or away, by no more than up to the poles.
glm::vec3 turned(const glm::vec3& offset, const ViewCamera& camera, float yaw, float pitch) {
    const float length = glm::length(offset);
    const float angle = std::acos(std::clamp(glm::dot(offset, camera.up) / length, -1.0f, 1.0f)); // from up
    const float wanted = std::clamp(angle - pitch, kPoleMargin, glm::pi<float>() - kPoleMargin);
    // This lies in the plane of `up` and `offset`; right(camera) is square to both, whichever way the offset
    // goes.
    const glm::vec3 side = right(camera);
    glm::vec3 flat = glm::cross(side, camera.up);
    if (glm::dot(flat, offset) < 0.0f) flat = -flat;
    flat = rotated(flat, yaw, camera.up);
    return length * (std::cos(wanted) * camera.up + std::sin(wanted) * flat);
}

// Returns what a file's camera turns about. Its own up leans back where it looks down, and turns about that
// would tilt the horizon: a camera that shows the horizon level turns about the upright.
glm::vec3 upOfFile(const glm::vec3& ahead, const glm::vec3& ownUp) {
    constexpr float kRoll = 1e-4f; // [rad]: what is rolled by more shows what the file says
    const glm::vec3 side = glm::normalize(glm::cross(ahead, ownUp));
    const bool level = std::abs(side.y) <= kRoll && ownUp.y > kPoleMargin;
    return level ? kUpright : ownUp;
}

} // namespace

glm::vec3 forward(const ViewCamera& camera) {
    return glm::normalize(camera.target - camera.eye);
}

glm::vec3 right(const ViewCamera& camera) {
    const glm::vec3 ahead = forward(camera);
    const glm::vec3 side = glm::cross(ahead, camera.up);
    constexpr float kParallel = 1e-5f;
    if (glm::length(side) > kParallel) return glm::normalize(side);
    const glm::vec3 other = std::abs(ahead.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
    return glm::normalize(glm::cross(ahead, glm::cross(other, ahead)));
}

glm::mat4 viewMatrix(const ViewCamera& camera) {
    const glm::vec3 ahead = forward(camera), side = right(camera), above = glm::cross(side, ahead);
    const glm::mat4 rotation =
        glm::transpose(glm::mat4(glm::vec4(side, 0.0f), glm::vec4(above, 0.0f), glm::vec4(-ahead, 0.0f),
                                 glm::vec4(0.0f, 0.0f, 0.0f, 1.0f)));
    return glm::translate(rotation, -camera.eye);
}

glm::mat4 projectionMatrix(const ViewCamera& camera, float aspect) {
    glm::mat4 m(0.0f);
    if (camera.halfHeight > 0.0f) {
        const float depth = camera.zfar - camera.znear;
        m[0][0] = 1.0f / (camera.halfHeight * aspect);
        m[1][1] = 1.0f / camera.halfHeight;
        m[2][2] = 1.0f / depth;
        m[3][2] = camera.zfar / depth;
        m[3][3] = 1.0f;
        return m;
    }
    const float cotangent = 1.0f / std::tan(0.5f * camera.yfov);
    m[0][0] = cotangent / aspect;
    m[1][1] = cotangent;
    m[2][3] = -1.0f;
    m[3][2] = camera.znear;
    return m;
}

ViewCamera orbit(const ViewCamera& camera, float yaw, float pitch) {
    ViewCamera moved = camera;
    moved.eye = camera.target + turned(camera.eye - camera.target, camera, yaw, pitch);
    return moved;
}

ViewCamera look(const ViewCamera& camera, float yaw, float pitch) {
    ViewCamera moved = camera;
    moved.target = camera.eye + turned(camera.target - camera.eye, camera, yaw, pitch);
    return moved;
}

std::vector<ViewCamera> turntable(const ViewCamera& camera, const Box& box, uint32_t count) {
    const bool inside = glm::all(glm::greaterThanEqual(camera.eye, box.low)) &&
                        glm::all(glm::lessThanEqual(camera.eye, box.high));
    const glm::vec3 pivot = inside ? camera.eye : camera.target;
    // It is the picture's own up, as what looks straight down has no other that turns with it.
    const glm::vec3 above = glm::cross(right(camera), forward(camera));
    std::vector<ViewCamera> out = {camera};
    for (uint32_t i = 1; i < count; ++i) {
        const float yaw = glm::two_pi<float>() * static_cast<float>(i) / static_cast<float>(count);
        ViewCamera moved = camera;
        moved.eye = pivot + rotated(camera.eye - pivot, yaw, kUpright);
        moved.target = pivot + rotated(camera.target - pivot, yaw, kUpright);
        moved.up = rotated(above, yaw, kUpright);
        out.push_back(moved);
    }
    return out;
}

ViewCamera pan(const ViewCamera& camera, float dx, float dy) {
    const float height = camera.halfHeight > 0.0f
                             ? 2.0f * camera.halfHeight
                             : 2.0f * glm::distance(camera.eye, camera.target) * std::tan(0.5f * camera.yfov);
    const glm::vec3 side = right(camera), above = glm::cross(side, forward(camera));
    const glm::vec3 move = height * (dx * side + dy * above);
    ViewCamera moved = camera;
    moved.eye += move;
    moved.target += move;
    return moved;
}

ViewCamera zoom(const ViewCamera& camera, float factor) {
    ViewCamera moved = camera;
    moved.halfHeight *= factor;
    if (camera.halfHeight <= 0.0f) moved.eye = camera.target + factor * (camera.eye - camera.target);
    return moved;
}

ViewCamera fly(const ViewCamera& camera, const glm::vec3& move) {
    const glm::vec3 step = move.x * right(camera) + move.y * camera.up + move.z * forward(camera);
    ViewCamera moved = camera;
    moved.eye += step;
    moved.target += step;
    return moved;
}

ViewCamera frameBox(const ViewCamera& camera, const Box& box, float aspect) {
    const glm::vec3 ahead = forward(camera), side = right(camera), above = glm::cross(side, ahead);
    const float tanY = std::tan(0.5f * camera.yfov), tanX = tanY * aspect;
    float distance = 0.0f, halfHeight = 0.0f;
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner = box.corner(i) - box.centre();
        const float x = std::abs(glm::dot(corner, side)), y = std::abs(glm::dot(corner, above));
        distance = std::max(distance, std::max(x / tanX, y / tanY) - glm::dot(corner, ahead));
        halfHeight = std::max(halfHeight, std::max(x / aspect, y));
    }
    // A point has no size: any distance shows it.
    const float diagonal = box.diagonal(), size = diagonal > 0.0f ? diagonal : 1.0f;
    if (distance <= 0.0f) distance = size;
    ViewCamera moved = camera;
    moved.target = box.centre();
    moved.znear = kNearShare * size;
    if (camera.halfHeight > 0.0f) {
        moved.halfHeight = halfHeight > 0.0f ? halfHeight : size;
        distance = size;
        moved.zfar = 2.0f * size;
    }
    moved.eye = moved.target - distance * ahead;
    return moved;
}

ViewCamera cameraOfFile(const Camera& camera, const Box& bounds) {
    const glm::vec3 eye(camera.transform[3]);
    const glm::vec3 ahead = -glm::normalize(glm::vec3(camera.transform[2]));
    const float diagonal = bounds.diagonal();
    // The target only says what orbits go about: level with the scene's middle, but never behind the eye.
    constexpr float kNearest = 0.1f; // of the diagonal
    const float distance = std::max(glm::dot(bounds.centre() - eye, ahead), kNearest * diagonal);
    ViewCamera view = cameraAt(eye, eye + distance * ahead, bounds);
    view.up = upOfFile(ahead, glm::normalize(glm::vec3(camera.transform[1])));
    view.yfov = camera.yfov;
    if (camera.znear > 0.0f) view.znear = camera.znear;
    if (!camera.perspective) {
        view.halfHeight = camera.ymag;
        view.znear = camera.znear;
        view.zfar = camera.zfar;
    }
    return view;
}

ViewCamera cameraAt(const glm::vec3& eye, const glm::vec3& target, const Box& bounds) {
    ViewCamera view;
    view.eye = eye;
    view.target = target;
    view.znear = kNearShare * bounds.diagonal();
    return view;
}

} // namespace relume
