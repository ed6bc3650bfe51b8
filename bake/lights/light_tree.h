#pragma once

#include <vector>

#include "bake/base/shader_types.h"

namespace relume {

/// Builds the tree over polygons that shaders/lib/light/pick_emitter.glsl descends: one polygon per leaf,
/// split where the sum of power times bounds' surface times spread of normals is least [Conty Estevez and
/// Kulla 2018], at most shader::kEmitterDepth deep. Without polygons it is a root of power 0. Deterministic;
/// O(n log n).
std::vector<shader::EmitterNode> buildLightTree(const std::vector<shader::EmitterPolygon>& polygons);

/// Returns the power that the choice among mesh lights goes by: area times mean of the radiance's components
/// [cd].
double emitterPower(const shader::EmitterPolygon& polygon);

} // namespace relume
