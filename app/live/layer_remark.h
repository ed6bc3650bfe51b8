#pragma once

#include <string>

#include "bake/baker/baker.h"
#include "bake/layers/layer_solver.h"

namespace relume {

/// Why a bake has no layer for each light, with the mend, one line; "" where none was wanted. settings: of
/// the bake, which is not layered.
std::string layerRemark(bool wanted, const SolverSettings& settings, const Baker& baker, const Scene& scene);

/// The lights that share layers.
std::vector<LightGroup> groupsOf(const LayerSolver& solver);
/// What that means for who edits them, with the mend, one line; "": none do.
std::string groupRemark(const std::vector<LightGroup>& groups);

} // namespace relume
