#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// A planar chart consists of connected triangles projected onto one plane without overlap.
struct PlanarChart {
    std::vector<uint32_t> triangles;
    std::vector<glm::dvec2> uv; // 3 per triangle [m], in the box from (0,0) to extent
    glm::dvec2 extent{0.0};     // [m], of the box of least area
};

/// Cuts triangles, given by three corners each [m], into planar charts. These grow over shared edges from the
/// largest triangle on, while normals stay within 45 degrees of its own and nothing overlaps. Triangles
/// without area are in no chart. It works for any input: open, not manifold, self-intersecting, of any scale.
std::vector<PlanarChart> cutPlanarCharts(const std::vector<glm::dvec3>& corners);

/// Makes one chart for each triangle that has an area.
std::vector<PlanarChart> cutSingleTriangles(const std::vector<glm::dvec3>& corners);

/// Turns the points so that their box has the least area, moves it to the origin and returns its extent.
glm::dvec2 turnToLeastBox(std::vector<glm::dvec2>& points);

} // namespace relume
