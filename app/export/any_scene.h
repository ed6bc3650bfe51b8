#pragma once

#include "app/export/engine_scene.h"
#include "app/export/surface_light.h"

namespace relume {

/// Turns a level into one that any glTF viewer shows as it is lit: its materials emit the light that leaves
/// the surfaces, times 2^exposure, from textures in the lightmap's layout, and reflect nothing. What shines
/// by itself has a texture of its own, as its light would leave the rest but few of the 256 steps. Returns
/// the textures' numbers, which want no mipmaps.
std::vector<int> lightByEmission(EngineScene& level, const SurfaceLight& light,
                                 const std::vector<Material>& originals, float exposure);

} // namespace relume
