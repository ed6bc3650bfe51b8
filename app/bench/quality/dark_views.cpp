#include "app/bench/quality/dark_views.h"

#include "assets/images/metrics.h"
#include "assets/survey/level_rooms.h"
#include "renderer/box.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/gtc/constants.hpp>

namespace relume {
namespace {

constexpr float kDarkShare = 0.25f;                  // of the patches
constexpr float kEyeHeight = 1.6f, kHeadRoom = 0.2f; // [m], of somebody who stands
constexpr float kFloor = 0.8f;                       // cosine of the steepest floor's slope
constexpr int kHeadings = 32, kProbes = 32;          // horizontal directions; directions all around
constexpr size_t kStands = 96, kSeen = 512; // floor patches and dark patches that are looked at, at most
const float kFov = glm::radians(60.0f);
constexpr float kAspect = 16.0f / 9.0f;
constexpr float kNear = 1e-3f; // of the level's diagonal: rays begin and end so far from surfaces

/// Somewhere to look from, and the dark patches in sight.
struct Stand {
    ViewCamera camera;
    std::vector<float> seen; // solid angle of each of the dark patches [sr]
};

// Returns every so manieth element, so that at most so many are left.
std::vector<LitPoint> thinned(const std::vector<LitPoint>& all, size_t most) {
    const size_t step = (all.size() + most - 1) / most;
    std::vector<LitPoint> some;
    for (size_t i = 0; i < all.size(); i += std::max<size_t>(step, 1))
        some.push_back(all[i]);
    return some;
}

// Tells whether the eye sees backs of surfaces, as one within something does.
bool isInside(const LevelRays& rays, const glm::vec3& eye) {
    for (int i = 0; i < kProbes; ++i) {
        const LevelHit hit = rays.trace(eye, evenDirection(i, kProbes));
        if (!std::isinf(hit.distance) && !hit.front) return true;
    }
    return false;
}

// Returns the eye above a floor patch, or nothing where there is no room for it.
std::optional<glm::vec3> eyeAbove(const LevelRays& rays, const LitPoint& floor, bool stands, float near) {
    const float room = rays.trace(floor.position + near * floor.normal, glm::vec3(0, 1, 0)).distance;
    if (stands && room < kEyeHeight + kHeadRoom) return {};
    const float height = stands ? kEyeHeight : std::min(kEyeHeight, 0.5f * room);
    const glm::vec3 eye = floor.position + glm::vec3(0, height, 0);
    if (isInside(rays, eye)) return {};
    return eye;
}

// Returns the longest horizontal way that ends at something; where all are open, the first of them.
glm::vec3 longestWay(const LevelRays& rays, const glm::vec3& eye) {
    glm::vec3 best(1, 0, 0);
    float longest = 0;
    for (int i = 0; i < kHeadings; ++i) {
        const float angle = 2.0f * glm::pi<float>() * static_cast<float>(i) / kHeadings;
        const glm::vec3 way(std::cos(angle), 0.0f, std::sin(angle));
        const float distance = rays.trace(eye, way).distance;
        if (std::isinf(distance) || distance <= longest) continue;
        longest = distance;
        best = way;
    }
    return best;
}

std::vector<float> darkSeen(const LevelRays& rays, const ViewCamera& camera,
                            const std::vector<LitPoint>& dark, float near) {
    const glm::vec3 ahead = forward(camera), side = right(camera), above = glm::cross(side, ahead);
    const float tanY = std::tan(0.5f * camera.yfov), tanX = kAspect * tanY;
    std::vector<float> seen;
    for (const LitPoint& point : dark) {
        seen.push_back(0.0f);
        const glm::vec3 way = point.position + near * point.normal - camera.eye;
        const float depth = glm::dot(way, ahead), distance = glm::length(way);
        if (depth <= near || std::abs(glm::dot(way, side)) > tanX * depth ||
            std::abs(glm::dot(way, above)) > tanY * depth)
            continue;
        const float cosine = -glm::dot(way, point.normal) / distance;
        if (cosine <= 0 || rays.trace(camera.eye, way).distance < 1.0f) continue;
        // What is at one's feet does not fill the picture more than its frame.
        seen.back() = std::min(point.area * cosine / (distance * distance), 1.0f);
    }
    return seen;
}

} // namespace

std::vector<ViewCamera> darkViews(const LevelRays& rays, std::span<const LitPoint> points, size_t count) {
    std::vector<float> light;
    Box bounds;
    for (const LitPoint& point : points) {
        bounds.add(point.position);
        if (point.light > 0) light.push_back(point.light);
    }
    if (light.empty()) return {};
    const auto most = static_cast<float>(nearestRank(light, kDarkShare));
    const float near = kNear * bounds.diagonal();
    std::vector<LitPoint> dark, floors;
    for (const LitPoint& point : points) {
        if (point.light <= 0 || point.light > most) continue;
        dark.push_back(point);
        if (point.normal.y > kFloor) floors.push_back(point);
    }
    dark = thinned(dark, kSeen);
    std::vector<Stand> stands;
    for (const bool standing : {true, false}) {
        for (const LitPoint& floor : thinned(floors, kStands)) {
            const std::optional<glm::vec3> eye = eyeAbove(rays, floor, standing, near);
            if (!eye) continue;
            ViewCamera camera =
                cameraAt(*eye, *eye + 0.5f * bounds.diagonal() * longestWay(rays, *eye), bounds);
            camera.yfov = kFov;
            stands.push_back({camera, darkSeen(rays, camera, dark, near)});
        }
        if (!stands.empty()) break;
    }
    std::vector<ViewCamera> views;
    while (views.size() < count) {
        float best = 0;
        const Stand* chosen = nullptr;
        for (const Stand& stand : stands) {
            float sum = 0;
            for (const float angle : stand.seen)
                sum += angle;
            if (sum <= best) continue;
            best = sum;
            chosen = &stand;
        }
        if (chosen == nullptr) break;
        views.push_back(chosen->camera);
        const std::vector<float> seen = chosen->seen;
        for (Stand& stand : stands)
            for (size_t i = 0; i < seen.size(); ++i)
                if (seen[i] > 0) stand.seen[i] = 0;
    }
    return views;
}

} // namespace relume
