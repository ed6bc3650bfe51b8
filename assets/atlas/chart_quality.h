#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>

namespace relume {

/// Sums of the stretch of triangles, by which charts are judged.
struct Stretch {
    double surface = 0.0; // area of the triangles [m^2]
    double flat = 0.0;    // area of their UVs [m^2]; triangles that are turned over count negative
    double squares = 0.0; // of the L2 stretch, weighted by area [m^2]

    /// Adds a triangle: three corners and three UVs, both in metres. A triangle whose UVs have no area, or
    /// are turned over, has infinite stretch.
    void add(const glm::dvec3* corners, const glm::dvec2* uv);
    void add(const Stretch& other);
    /// Returns the L2 stretch [Sander et al. 2001, eq. 3 and 4], normalised by the areas so that 1 is
    /// isometric and no uniform scale counts; infinity where a triangle is turned over.
    double normalised() const;
};

/// Measures triangles of three corners and three UVs each.
Stretch measureStretch(std::span<const glm::dvec3> corners, std::span<const glm::dvec2> uv);

/// Tells whether any two triangles of a chart, given by three UVs each and counter-clockwise, cover each
/// other deeper than a millionth of the chart's extent. Where many thin triangles share a place it counts
/// cells of a grid instead of comparing all pairs, and then calls cells that are covered twice an overlap.
/// With `second` > 0 only triangles before `second` are compared with those from it on.
bool chartOverlaps(std::span<const glm::dvec2> uv, size_t second = 0);

} // namespace relume
