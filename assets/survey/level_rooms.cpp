#include "assets/survey/level_rooms.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/gtc/constants.hpp>

namespace relume {
namespace {

constexpr int kRays = 64;           // of a point, in all directions
constexpr int kMostBacks = 3;       // of them that a place may see: of a leaf, a flag, a hole in a mesh
constexpr int kCrackRays = 1;       // that may find the sky through a crack
constexpr float kOpenShare = 0.02f; // of the places, which an interior that is not quite tight may have open
// Points of the grid along the longest edge, and the fewest along any other.
constexpr int kMostAlong = 14, kFewestAlong = 5;

glm::ivec3 gridOf(const glm::vec3& size) {
    const float longest = std::max({size.x, size.y, size.z});
    glm::ivec3 grid(kFewestAlong);
    for (int axis = 0; axis < 3 && longest > 0.0f; ++axis)
        grid[axis] = std::max(kFewestAlong, static_cast<int>(std::lround(kMostAlong * size[axis] / longest)));
    return grid;
}

} // namespace

glm::vec3 evenDirection(int index, int count) {
    const float z = 1.0f - (2.0f * static_cast<float>(index) + 1.0f) / static_cast<float>(count);
    const float angle = static_cast<float>(index) * glm::pi<float>() * (3.0f - std::sqrt(5.0f));
    const float radius = std::sqrt(1.0f - z * z);
    return {radius * std::cos(angle), z, radius * std::sin(angle)};
}

LevelRooms findRooms(const LevelRays& rays, const glm::vec3& low, const glm::vec3& high) {
    const glm::ivec3 grid = gridOf(high - low);
    LevelRooms rooms;
    size_t open = 0;
    for (int k = 0; k < grid.x * grid.y * grid.z; ++k) {
        const glm::ivec3 cell(k % grid.x, k / grid.x % grid.y, k / (grid.x * grid.y));
        const glm::vec3 point = low + (glm::vec3(cell) + 0.5f) / glm::vec3(grid) * (high - low);
        int backs = 0, sky = 0;
        for (int i = 0; i < kRays && backs <= kMostBacks; ++i) {
            const LevelHit hit = rays.trace(point, evenDirection(i, kRays));
            if (std::isinf(hit.distance))
                ++sky;
            else
                backs += hit.front ? 0 : 1;
        }
        if (backs > kMostBacks) continue;
        open += sky > kCrackRays ? 1 : 0;
        rooms.places.push_back({point, static_cast<float>(sky) / kRays});
    }
    rooms.closed = !rooms.places.empty() &&
                   static_cast<float>(open) <= kOpenShare * static_cast<float>(rooms.places.size());
    return rooms;
}

glm::vec3 clearestPoint(const LevelRays& rays, const std::vector<LevelPlace>& places) {
    ASSERT(!places.empty());
    glm::vec3 best = places.front().point;
    float most = 0.0f;
    for (const LevelPlace& place : places) {
        const float clear = rays.clearance(place.point);
        if (clear <= most || std::isinf(clear)) continue;
        best = place.point;
        most = clear;
    }
    // Steps as long as half of the clearance cannot leave the room: every point on the way is clear.
    float step = 0.5f * most;
    constexpr float kFinest = 0.01f; // of the clearance
    while (step > kFinest * most) {
        const glm::vec3 from = best;
        for (int axis = 0; axis < 3; ++axis)
            for (const float sign : {-1.0f, 1.0f}) {
                glm::vec3 point = from;
                point[axis] += sign * step;
                const float clear = rays.clearance(point);
                if (clear <= most) continue;
                best = point;
                most = clear;
            }
        if (best == from) step *= 0.5f;
    }
    return best;
}

} // namespace relume
