#include "renderer/good_view.h"

#include "assets/survey/level_rooms.h"
#include "assets/survey/street_view.h"
#include "renderer/scene_geometry.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include <glm/gtc/constants.hpp>

namespace relume {
namespace {

constexpr int kProbeRays = 32;     // of an eye, in all directions
constexpr float kRoomShare = 0.8f; // of them that must meet a front: a room may have a door and windows

// What is wrong with an eye, as this share of its rays meets backs: it is behind a wall or below the ground.
constexpr float kBackShare = 0.1f;
const float kWide = glm::radians(60.0f); // rooms are seen from within

bool isInRoom(const LevelRays& rays, const glm::vec3& eye) {
    int fronts = 0;
    for (int i = 0; i < kProbeRays; ++i)
        fronts += rays.trace(eye, evenDirection(i, kProbeRays)).front ? 1 : 0;
    return static_cast<float>(fronts) >= kRoomShare * kProbeRays;
}

// Calls back with what each ray of a grid over the picture meets.
constexpr int kColumns = 14, kRows = 10;
void lookAround(const LevelRays& rays, const ViewCamera& camera, float aspect,
                const std::function<void(const LevelHit&)>& meets) {
    const glm::vec3 ahead = forward(camera), side = right(camera), above = glm::cross(side, ahead);
    const float tanY = std::tan(0.5f * camera.yfov);
    for (int i = 0; i < kColumns * kRows; ++i) {
        const float x = 2.0f * (static_cast<float>(i % kColumns) + 0.5f) / kColumns - 1.0f;
        const float y = 2.0f * (static_cast<float>(i / kColumns) + 0.5f) / kRows - 1.0f;
        meets(rays.trace(camera.eye, glm::normalize(ahead + tanY * (aspect * x * side + y * above))));
    }
}

// Returns how far one sees, as the geometric mean over the picture's rays, so that something close before the
// eye counts much. It is in shares of `scale`, and 0 where a ray meets a back, for then the eye is inside
// something.
float openness(const LevelRays& rays, const ViewCamera& camera, float aspect, float scale) {
    float sum = 0.0f;
    bool inside = false;
    lookAround(rays, camera, aspect, [&](const LevelHit& hit) {
        const bool open = std::isinf(hit.distance);
        inside = inside || (!open && !hit.front);
        sum += std::log(open ? 1.0f : std::clamp(hit.distance / scale, 1e-4f, 1.0f));
    });
    return inside ? 0.0f : std::exp(sum / (kColumns * kRows));
}

// Returns the share of the picture that the level fills, and 0 where its backs are seen.
float filling(const LevelRays& rays, const ViewCamera& camera, float aspect) {
    int fronts = 0, backs = 0;
    lookAround(rays, camera, aspect, [&](const LevelHit& hit) {
        if (!std::isinf(hit.distance)) ++(hit.front ? fronts : backs);
    });
    const bool behind = static_cast<float>(backs) > kBackShare * static_cast<float>(fronts + backs);
    return behind ? 0.0f : static_cast<float>(fronts) / (kColumns * kRows);
}

struct BestView {
    ViewCamera camera;
    float score = 0.0f;

    void take(const ViewCamera& other, float otherScore) {
        if (otherScore <= score) return;
        camera = other;
        score = otherScore;
    }
};

// The eyes stand before the room's corners and the middles of its walls, a little above half its height; they
// look a little down.
BestView viewFromCorners(const LevelRays& rays, const Box& bounds, float aspect) {
    const glm::vec3 centre = bounds.centre(), half = 0.5f * bounds.size();
    BestView best;
    for (int i = 0; i < 8; ++i) {
        constexpr float kInset = 0.8f, kHeight = 0.15f;
        const float angle = 0.25f * glm::pi<float>() * static_cast<float>(i + 1);
        const bool corner = i % 2 == 0;
        const float reach = corner ? std::sqrt(2.0f) : 1.0f;
        const glm::vec3 offset = kInset * reach * glm::vec3(std::cos(angle), 0.0f, std::sin(angle)) * half;
        ViewCamera camera = cameraAt(centre + offset + glm::vec3(0.0f, kHeight * half.y, 0.0f),
                                     centre - glm::vec3(0.0f, kHeight * half.y, 0.0f), bounds);
        camera.yfov = kWide;
        if (camera.eye == camera.target || !isInRoom(rays, camera.eye)) continue;
        best.take(camera, openness(rays, camera, aspect, bounds.diagonal()));
    }
    return best;
}

// In an interior that is no box, the eyes are wherever there is air, and look to where most of it is.
BestView viewFromRooms(const LevelRays& rays, const Box& bounds, float aspect) {
    const LevelRooms rooms = findRooms(rays, bounds.low, bounds.high);
    BestView best;
    if (!rooms.closed) return best;
    const glm::vec3 target = clearestPoint(rays, rooms.places);
    for (const LevelPlace& place : rooms.places) {
        if (place.point == target) continue;
        ViewCamera camera = cameraAt(place.point, target, bounds);
        camera.yfov = kWide;
        best.take(camera, openness(rays, camera, aspect, bounds.diagonal()));
    }
    return best;
}

// Tells whether all of these points are in the picture, but for a margin.
bool seesAll(const ViewCamera& camera, float aspect, std::span<const glm::vec3> points, size_t step) {
    constexpr float kMargin = 0.95f;
    const glm::vec3 ahead = forward(camera), side = right(camera), above = glm::cross(side, ahead);
    const float tanY = kMargin * std::tan(0.5f * camera.yfov), tanX = aspect * tanY;
    for (size_t i = 0; i < points.size(); i += step) {
        const glm::vec3 way = points[i] - camera.eye;
        const float depth = glm::dot(way, ahead);
        if (depth <= 0.0f || std::abs(glm::dot(way, above)) > tanY * depth ||
            std::abs(glm::dot(way, side)) > tanX * depth)
            return false;
    }
    return true;
}

// Comes closer while the level is in the picture. The eye stays outside, as all of the level is before it.
ViewCamera comeCloser(const ViewCamera& camera, float aspect, const WorldMesh& mesh) {
    constexpr size_t kLooked = 100000; // points at most: a share of a large level tells its outline
    const size_t step = mesh.positions.size() / kLooked + 1;
    float near = 0.1f, far = 1.0f; // shares of the distance
    for (int i = 0; i < 10; ++i) {
        const float middle = 0.5f * (near + far);
        (seesAll(zoom(camera, middle), aspect, mesh.positions, step) ? far : near) = middle;
    }
    return zoom(camera, far);
}

// A quarter view from outside and a little above; from the side where the level fills the picture, and its
// backs are not seen.
ViewCamera viewFromOutside(const LevelRays& rays, const Box& bounds, float aspect) {
    const glm::vec3 centre = bounds.centre();
    constexpr float kBetter = 1.1f; // so much another side must be to be chosen
    std::optional<BestView> best;
    for (const glm::vec2 side : {glm::vec2(0.7f, 1.0f), {1.0f, -0.7f}, {-0.7f, -1.0f}, {-1.0f, 0.7f}}) {
        const ViewCamera camera =
            frameBox(cameraAt(centre + glm::vec3(side.x, 0.5f, side.y), centre, bounds), bounds, aspect);
        const float score = filling(rays, camera, aspect);
        if (!best || score > kBetter * best->score) best = BestView{camera, score};
    }
    return best->camera;
}

} // namespace

ViewCamera goodView(const WorldMesh& mesh, float aspect) {
    const Box bounds = boundsOf(mesh);
    const LevelRays rays(mesh);
    BestView best = viewFromCorners(rays, bounds, aspect);
    if (best.score <= 0.0f) best = viewFromRooms(rays, bounds, aspect);
    if (best.score > 0.0f) return best.camera;
    const std::optional<StandingView> view = standingView(rays, bounds.low, bounds.high, aspect);
    if (view) {
        ViewCamera camera = cameraAt(view->eye, view->target, bounds);
        camera.yfov = kStandingFov;
        return camera;
    }
    return comeCloser(viewFromOutside(rays, bounds, aspect), aspect, mesh);
}

} // namespace relume
