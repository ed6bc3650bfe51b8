#pragma once

#include <string>

#include "bake/baker.h"

namespace relume {

/// Why a bake has no layer for each light, with the mend, one line; "" where none was wanted. settings: of
/// the bake, which is not layered.
std::string layerRemark(bool wanted, const SolverSettings& settings, const Baker& baker, const Scene& scene);

} // namespace relume
