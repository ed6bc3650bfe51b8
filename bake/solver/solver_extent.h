#pragma once

#include <cstdint>
#include <optional>

#include "bake/base/shader_types.h"

namespace relume {

/// The lights of a scene, as far as they decide how much memory direct light takes.
struct LightExtent {
    uint32_t polygons = 0;      // of all mesh lights
    uint32_t polygonsOfOne = 0; // of the mesh light that has most
    uint32_t extended = 0;      // analytic lights with an extent
    uint32_t points = 0;        // those without
};

/// Holds what decides how much device memory a solver takes, beside its settings. What is not known is taken
/// as large as it can get.
struct SolverExtent {
    uint32_t chunkCount = 0; // of patches
    uint64_t texels = 0;     // of the lightmap
    bool software = false;   // the device is the CPU
    uint64_t skyPixels = 0;  // of the sky's picture
    uint64_t skyRows = 0;
    std::optional<LightExtent> lights = {};
    // These count padding, too.
    std::optional<uint64_t> senders = {};   // of a pair method's list
    std::optional<uint64_t> receivers = {}; // of the link methods' coarser grid
    std::optional<uint64_t> nodes = {};     // of the footprints' pyramid

    uint64_t patches() const { return uint64_t{chunkCount} * shader::kChunk; } // with padding
};

} // namespace relume
