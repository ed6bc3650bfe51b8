#pragma once

#include <cstdint>

#include "assets/model/scene.h"
#include "bake/surface/trace_scene.h"

namespace relume {

/// Offsets into the alpha bytes are 32 bits wide, and the largest of them says that there is no texture.
constexpr uint64_t kMostAlphaBytes = 0xffffffffu;

/// Returns a masked triangle's coordinates and vertex alpha, as the tracers' test has them.
shader::AlphaTriangle alphaTriangle(const WorldMesh& mesh, uint32_t triangle, uint32_t material);

/// Returns the image whose alpha a material's mask has, -1: none.
int alphaImage(const Scene& scene, const Material& material);

/// Returns a material's mask, the alpha of whose image begins at this byte.
shader::AlphaMaterial alphaMaterial(const Scene& scene, const Material& material, uint32_t texels);

/// Fills in the alpha triangles, materials and texels of the mesh that is there. An image's alpha is there
/// once, however many materials have it. Throws Error where all images together have more than `most` bytes
/// of it.
void addAlphaTables(const Scene& scene, TraceScene& traced, uint64_t most = kMostAlphaBytes);

} // namespace relume
