#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

constexpr uint32_t kMostDirections = 65'536;

/// Returns points of the unit disc, made by insertion into the largest empty circle as RTRad's directions
/// are: each new point is the vertex of the Voronoi diagram of those before it that is farthest from them. A
/// circle is empty up to twice its centre's distance from the border, beyond which the point's own mirror
/// image would be nearer than any other: without that, a fifth of 256 points would lie on the border itself.
/// The first n points are the set of n. This is deterministic and takes O(n log n). count <= kMostDirections.
std::vector<glm::dvec2> largestEmptyCircleDisc(uint32_t count);

/// Returns the same points in their order, with their distances from the centre evened out: the k-th nearest
/// gets the middle of the k-th of equally large rings. Insertion leaves one region denser than another until
/// a generation of circles is filled, a bias of 1 %; rings of their own take it away, and a point's place
/// within its ring may be drawn at random.
std::vector<glm::dvec2> evenRings(std::vector<glm::dvec2> points);

/// Projects up onto the unit hemisphere around +z: even points of the disc become cosine-distributed
/// directions [Nusselt 1928].
glm::dvec3 projectedUp(glm::dvec2 point);

} // namespace relume
