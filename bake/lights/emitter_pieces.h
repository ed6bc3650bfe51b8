#pragma once

#include <vector>

#include "assets/atlas/world_mesh.h"

namespace relume {

/// A triangle or parallelogram of the mesh with all that varies linearly over it: at (s, t) a quantity is [0]
/// + s [1] + t [2], with s and t in [0, 1], and s + t <= 1 for a triangle.
struct EmitterSurface {
    glm::dvec3 position[3] = {};
    glm::dvec2 emissionUv[3] = {}, baseUv[3] = {};
    double alpha[3] = {1, 0, 0}; // of the vertex colours
    double area = 0;             // [m^2]
    bool isTriangle = true;
    uint32_t triangle = 0; // in the WorldMesh
    uint32_t material = 0; // into Scene::materials
};

/// Part of a surface: origin + s along0 + t along1 in the surface's (s, t), a triangle or parallelogram as
/// the surface is.
struct EmitterPiece {
    uint32_t surface = 0; // index
    glm::dvec2 origin{0.0}, along0{1.0, 0.0}, along1{0.0, 1.0};
    double area = 0;          // [m^2]
    glm::dvec3 radiance{0.0}; // [cd/m^2], its mean
};

struct PieceList {
    std::vector<EmitterPiece> pieces; // by surface, then in the order of splitting; none of them black
    bool capped = false;              // maxPieces was reached, so some are coarser than they should be
};

/// Splits surfaces whose emission a texture or a mask varies into pieces of about one radiance: until it
/// spreads by less than 3 % of the brightest radiance of all, or the piece is smaller than two texels; the
/// coarsest first. Emission is sampled from the full-size texture, bilinear unless the texture says nearest;
/// masks have the holes of the tracers' alpha test. The mean is right for each piece. With `unit` all
/// emission factors count as 1.
PieceList splitEmission(const Scene& scene, const std::vector<EmitterSurface>& surfaces, uint32_t maxPieces,
                        bool unit = false);

/// Tells whether the emission of this material may differ from place to place.
bool variesOverSurface(const Material& material);

} // namespace relume
