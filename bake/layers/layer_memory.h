#pragma once

#include "bake/gather/link_passes.h"

namespace relume {

/// The ledger counts what layers take as that of this owner (vk::MemoryOwner).
constexpr const char* kLayersOwner = "layers";

/// Returns the most device bytes that LayerSolver takes at a time, beside LightBuffers, layers
/// (LayerSettings::bytes) and kept links (LinkCache::bytes).
uint64_t layerSolverBytes(const SolverExtent& extent, const SolverSettings& settings);

} // namespace relume
