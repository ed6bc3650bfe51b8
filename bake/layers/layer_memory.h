#pragma once

#include "bake/gather/link_passes.h"

namespace relume {

/// The ledger counts what layers take as that of this owner (vk::MemoryOwner).
constexpr const char* kLayersOwner = "layers";

/// Returns the most bytes that LayerSolver takes at a time, beside LightBuffers, layers
/// (LayerSettings::bytes) and kept links (LinkCache::bytes).
SpilledBytes layerSolverBytes(const SolverExtent& extent, const SolverSettings& settings);

} // namespace relume
