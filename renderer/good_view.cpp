#include "renderer/good_view.h"

#include "renderer/scene_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/gtc/constants.hpp>

namespace relume {
namespace {

constexpr int kProbeRays = 32;     // of an eye, in all directions
constexpr float kRoomShare = 0.8f; // of them that must meet a front: a room may have a door and windows

struct Hit {
    float distance = std::numeric_limits<float>::infinity(); // in lengths of the direction
    bool front = false;
};

// Returns the nearest triangle along a ray [Moeller and Trumbore 1997]. All triangles are tried: there are a
// few hundred rays only.
Hit trace(const WorldMesh& mesh, const glm::vec3& origin, const glm::vec3& direction) {
    Hit nearest;
    for (size_t i = 0; i < mesh.positions.size(); i += 3) {
        const glm::vec3 a = mesh.positions[i + 1] - mesh.positions[i],
                        b = mesh.positions[i + 2] - mesh.positions[i];
        const glm::vec3 p = glm::cross(direction, b);
        const float determinant = glm::dot(a, p);
        if (determinant == 0.0f) continue;
        const glm::vec3 s = origin - mesh.positions[i];
        const float u = glm::dot(s, p) / determinant;
        if (u < 0.0f || u > 1.0f) continue;
        const glm::vec3 q = glm::cross(s, a);
        const float v = glm::dot(direction, q) / determinant;
        if (v < 0.0f || u + v > 1.0f) continue;
        const float t = glm::dot(b, q) / determinant;
        if (t > 0.0f && t < nearest.distance) nearest = {t, determinant > 0.0f};
    }
    return nearest;
}

// Returns a direction of a set that is even over the sphere: a spiral of golden angles [Vogel 1979, on the
// sphere].
glm::vec3 probeDirection(int index) {
    const float z = 1.0f - (2.0f * static_cast<float>(index) + 1.0f) / kProbeRays;
    const float angle = static_cast<float>(index) * glm::pi<float>() * (3.0f - std::sqrt(5.0f));
    const float radius = std::sqrt(1.0f - z * z);
    return {radius * std::cos(angle), z, radius * std::sin(angle)};
}

bool isInRoom(const WorldMesh& mesh, const glm::vec3& eye) {
    int fronts = 0;
    for (int i = 0; i < kProbeRays; ++i)
        fronts += trace(mesh, eye, probeDirection(i)).front ? 1 : 0;
    return static_cast<float>(fronts) >= kRoomShare * kProbeRays;
}

// Returns how far one sees, as the geometric mean over a grid of the picture's rays, so that something close
// before the eye counts much. It is in shares of `scale`, and 0 where a ray meets a back, for then the eye is
// inside something.
float openness(const WorldMesh& mesh, const ViewCamera& camera, float aspect, float scale) {
    constexpr int kColumns = 7, kRows = 5;
    const glm::vec3 ahead = forward(camera), side = right(camera), above = glm::cross(side, ahead);
    const float tanY = std::tan(0.5f * camera.yfov);
    float sum = 0.0f;
    for (int i = 0; i < kColumns * kRows; ++i) {
        const float x = 2.0f * (static_cast<float>(i % kColumns) + 0.5f) / kColumns - 1.0f;
        const float y = 2.0f * (static_cast<float>(i / kColumns) + 0.5f) / kRows - 1.0f;
        const Hit hit =
            trace(mesh, camera.eye, glm::normalize(ahead + tanY * (aspect * x * side + y * above)));
        const bool open = std::isinf(hit.distance);
        if (!open && !hit.front) return 0.0f;
        sum += std::log(open ? 1.0f : std::clamp(hit.distance / scale, 1e-4f, 1.0f));
    }
    return std::exp(sum / (kColumns * kRows));
}

} // namespace

ViewCamera goodView(const WorldMesh& mesh, float aspect) {
    const Box bounds = boundsOf(mesh);
    const glm::vec3 centre = bounds.centre(), half = 0.5f * bounds.size();
    ViewCamera best;
    float bestScore = 0.0f;
    // The eyes stand before the room's corners and the middles of its walls, a little above half its height;
    // they look a little down.
    for (int i = 0; i < 8; ++i) {
        constexpr float kInset = 0.8f, kHeight = 0.15f;
        const float angle = 0.25f * glm::pi<float>() * static_cast<float>(i + 1);
        const bool corner = i % 2 == 0;
        const float reach = corner ? std::sqrt(2.0f) : 1.0f;
        const glm::vec3 offset = kInset * reach * glm::vec3(std::cos(angle), 0.0f, std::sin(angle)) * half;
        ViewCamera camera = cameraAt(centre + offset + glm::vec3(0.0f, kHeight * half.y, 0.0f),
                                     centre - glm::vec3(0.0f, kHeight * half.y, 0.0f), bounds);
        camera.yfov = glm::radians(60.0f); // wide: rooms are seen from within
        if (camera.eye == camera.target || !isInRoom(mesh, camera.eye)) continue;
        const float score = openness(mesh, camera, aspect, bounds.diagonal());
        if (score <= bestScore) continue;
        best = camera;
        bestScore = score;
    }
    if (bestScore > 0.0f) return best;
    const ViewCamera outside = cameraAt(centre + glm::vec3(0.7f, 0.5f, 1.0f), centre, bounds);
    return frameBox(outside, bounds, aspect);
}

} // namespace relume
