#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// Triangles whose equal corners are one vertex, and which know their neighbours. A half-edge has the number
/// of the corner that it starts from, 3 * triangle + k; it runs to the next corner of its triangle.
struct WeldedMesh {
    std::vector<glm::dvec3> corners; // 3 per triangle [m]
    std::vector<uint32_t> vertex;    // per corner, numbered by first appearance
    std::vector<uint32_t> opposite;  // per half-edge: the one on the other side, kNoNumber: a border
    std::vector<glm::dvec3> normal;  // per triangle, unit; zero where it has no area
    std::vector<double> area;        // per triangle [m^2], 0: it has none
    uint32_t vertices = 0;

    uint32_t triangleCount() const { return static_cast<uint32_t>(area.size()); }
    static uint32_t nextCorner(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
    static uint32_t previousCorner(uint32_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }
};

/// Welds corners of exactly equal positions. Two triangles are neighbours where they run along an edge in
/// opposite directions; where more than two meet, those that continue each other most evenly are paired, so
/// that either side of a doubled wall holds together. Triangles without area have no neighbours.
WeldedMesh weld(std::vector<glm::dvec3> corners);

} // namespace relume
