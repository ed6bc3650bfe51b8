#pragma once

#include <cstdint>

#include "assets/model/scene.h"

namespace relume {

/// Splits each triangle of a scene into parts * parts ones of its own shape, which lie where it lay: a larger
/// level that looks and is lit the same. Normals are interpolated and made unit again; UVs and colours are
/// interpolated. Two triangles that share an edge have the same points on it, to the bit, whatever vertices
/// they have it by. parts: 1 to kMostParts.
void splitTriangles(Scene& scene, uint32_t parts);
constexpr uint32_t kMostParts = 16;

} // namespace relume
