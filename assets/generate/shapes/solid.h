#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume::generate {

struct ChartVertex {
    glm::dvec3 position{0.0}; // [m]
    glm::dvec2 place{0.0};    // in the chart's rectangle, [0,1]
    glm::dvec2 texCoord{0.0}; // [m] on the surface; the material knows how large a tile is
};

/// A chart is a piece of surface with its own rectangle in the lightmap atlas. Fronts are counter-clockwise;
/// seen from the front place.x grows to the right and place.y downwards.
struct Chart {
    std::vector<ChartVertex> vertices;
    std::vector<uint32_t> indices; // 3 per triangle; one with two equal corners is dropped later
    glm::dvec2 size{1.0};          // [m] of the rectangle: decides how many texels it gets
    double density = 1.0;          // texels per metre, relative to the rest of the scene
    int material = 0;              // as SceneBuilder numbers them
};

/// Charts that become one mesh. Vertices at the same position are one corner of the surface: normals are
/// smoothed over them where the surface bends by less than the crease angle.
struct Solid {
    std::vector<Chart> charts;

    Solid& add(Solid other);
    Solid& move(const glm::dvec3& offset);
    Solid& turn(const glm::dmat3& rotation);
    Solid& turnY(double degrees); // counter-clockwise seen from above
    Solid& paint(int material);
    Solid& denser(double factor);
};

/// Rounds coordinates to multiples of 2^-14 m (0.06 mm). The libraries' sines and cosines differ in the last
/// bits, which scenes must not, and corners that should meet do so exactly.
glm::dvec3 snap(const glm::dvec3& position);

/// Rounds to the nearest whole number; exact halves, which symmetric shapes make, are kept off the edge.
double roundSteadily(double x);

} // namespace relume::generate
