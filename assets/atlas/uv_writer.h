#pragma once

#include <vector>

#include "assets/atlas/chart_layout.h"
#include "assets/model/scene.h"

namespace relume {

/// The UVs of a mesh's triangle corners, and which chart each triangle belongs to.
struct CornerUvs {
    std::vector<glm::vec2> uv;   // 3 per triangle
    std::vector<uint32_t> chart; // per triangle, kNoNumber: no area
};

/// Returns the UVs of `triangles` triangles whose charts lie at `places`; `cells` of them are one unit, and
/// their origin lies `border` cells off that of the UVs.
CornerUvs cornerUvs(const std::vector<PlanarChart>& charts, const ChartPlace* places, double cells,
                    double border, size_t triangles);

/// Returns the mesh with the UVs as TEXCOORD_1; a vertex that has several UVs becomes several.
Mesh withUvs(const Mesh& mesh, const CornerUvs& uvs);

/// Tells whether a mesh's textures leave it one of three sets of UVs.
bool canFreeSecondSet(const Scene& scene, const Mesh& mesh);
/// Frees TEXCOORD_1 of a mesh whose textures use it, by copying it to TEXCOORD_0 or, where textures use that
/// too, to TEXCOORD_2 (Primitive::movedUvs). A primitive whose textures use all three stays as it is.
void freeSecondSet(const Scene& scene, Mesh& mesh);

} // namespace relume
