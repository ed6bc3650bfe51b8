#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <glm/glm.hpp>

#include "assets/model/scene.h"

// These are the tools of painters by arithmetic. All of them give the same on every platform.
namespace relume::generate {

/// Returns a colour by place in the picture, [0,1] from the top left corner, sRGB encoded as a painter mixes
/// it.
using Painter = std::function<glm::dvec3(glm::dvec2 place)>;
/// Returns the same with coverage as fourth channel, 1 where the surface is and 0 in a hole.
using MaskPainter = std::function<glm::dvec4(glm::dvec2 place)>;

Image paintImage(const std::string& name, uint32_t width, uint32_t height, const Painter& painter);
Image paintMasked(const std::string& name, uint32_t width, uint32_t height, const MaskPainter& painter);

/// Hashes integers to [0,1); its rounds of xor, shift and multiply follow the usual 32-bit finalizers.
double random(uint32_t x, uint32_t y, uint32_t seed);

/// Returns smooth noise on a lattice of periodX by periodY cells; p is in cells.
double noise(const glm::dvec2& p, uint32_t periodX, uint32_t periodY, uint32_t seed);

/// Rises from 0 at `low` to 1 at `high` without a bend; falls where high < low.
double step(double low, double high, double x);

} // namespace relume::generate
