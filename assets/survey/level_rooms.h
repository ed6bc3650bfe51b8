#pragma once

#include <vector>

#include "assets/survey/level_rays.h"

namespace relume {

/// A place in the air of a level, by what is seen from there all around.
struct LevelPlace {
    glm::vec3 point{0.0f};
    float sky = 0.0f; // share of all directions in which nothing is met
};

/// Says what a level is like inside its bounds.
struct LevelRooms {
    std::vector<LevelPlace> places; // in the air: of a grid, those that see fronts and sky only
    /// Tells whether the level is a closed interior: there are places, and from none is the sky seen.
    bool closed = false;
};

/// Looks around from a grid of points inside the level's bounds. A point that sees backs of triangles is in
/// something, or behind a wall that has one side only, and is no place. A crack through which next to nothing
/// of the sky is seen leaves an interior closed.
LevelRooms findRooms(const LevelRays& rays, const glm::vec3& low, const glm::vec3& high);

/// Returns the point farthest from all triangles [m, world] that is found from these places; the first place
/// where there is no better one. There must be places.
glm::vec3 clearestPoint(const LevelRays& rays, const std::vector<LevelPlace>& places);

/// Returns direction `index` of `count` that are even over the sphere: a spiral of golden angles [Vogel 1979,
/// on the sphere].
glm::vec3 evenDirection(int index, int count);

} // namespace relume
