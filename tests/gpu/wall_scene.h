#pragma once

#include <array>

#include "renderer/draw_settings.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gl_environment.h"

namespace relume {

constexpr uint32_t kWallSize = 64; // lightmap of the wall [texels]

using LightTexel = std::array<float, 4>; // R, G, B, coverage

/// Makes a lightmap of one value, or of two: the second from column `split` on.
FloatImage lightmapOf(LightTexel first, LightTexel second, uint32_t split);
FloatImage lightmapOf(float light);

/// Makes a wall of 2 m x 2 m in z = 0 that faces +z; its chart is all of the lightmap, and u runs along x.
SceneMaker wall(const Material& material);

Material grey(float albedo, float emission = 0.0f);

/// Returns a camera that sees just the wall, from the front (z > 0) or from behind.
ViewCamera before(float z = 5.0f);

/// Returns settings without tone mapping, with an exposure of 0 EV.
DrawSettings plain(View view = View::Lit, LightmapFilter filter = LightmapFilter::Bilinear);

/// Returns what a PNG has for a linear value.
int encoded(double linear);

} // namespace relume
