#pragma once

#include <span>
#include <vector>

#include "bake/base/shader_types.h"

namespace relume {

/// Returns the edges of polygons, which tell what all of them bring without shadows
/// (shaders/lib/light/whole_emitter.glsl). An edge that another polygon walks the other way, between the very
/// same corners, is one with that; edges without length are left out.
std::vector<shader::EmitterEdge> emitterEdges(std::span<const shader::EmitterPolygon> polygons);

} // namespace relume
