#pragma once

#include <string>

#include "bake/baker/baker.h"
#include "bake/layers/layer_solver.h"

namespace relume {

/// Tells in one line why a bake has no layer for each light, with the remedy; "" where layers were not
/// wanted. The settings are those of the bake, which is not layered.
std::string layerRemark(bool wanted, const SolverSettings& settings, const Baker& baker, const Scene& scene);

/// Returns the lights that share layers.
std::vector<LightGroup> groupsOf(const LayerSolver& solver);
/// Tells in one line what shared layers mean for an edit, with the remedy; "" when no lights share one.
std::string groupRemark(const std::vector<LightGroup>& groups);

} // namespace relume
