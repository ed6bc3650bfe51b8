#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/surface/trace_scene.h"

namespace relume {

/// Turns tiles of texels that a camera sees (8 x 8 texels, row by row) into chunks of patches: 1 for each
/// that has a patch in one of them, for Solver::setPriority().
std::vector<uint8_t> seenChunks(const TraceScene& scene, std::span<const uint32_t> tiles);

} // namespace relume
