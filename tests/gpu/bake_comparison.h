#pragma once

#include <cstring>

#include "tests/gpu/bake_scene.h"

namespace relume {

inline bool sameBytes(const FloatImage& a, const FloatImage& b) {
    if (a.planes.size() != b.planes.size()) return false;
    for (size_t k = 0; k < a.planes.size(); ++k) {
        if (a.planes[k].size() != b.planes[k].size()) return false;
        if (std::memcmp(a.planes[k].data(), b.planes[k].data(), a.planes[k].size() * sizeof(float)) != 0)
            return false;
    }
    return true;
}

/// Returns area times reflected light [cd] of all patches that are shown.
inline double reflectedFlux(const Baked& baked) {
    double flux = 0;
    const std::vector<uint32_t>& map = baked.patches.scene.texelToPatch;
    for (size_t texel = 0; texel < map.size(); ++texel) {
        if (map[texel] == shader::kNoPatch) continue;
        const uint32_t i = map[texel];
        double light = 0;
        for (size_t k = 0; k < 3; ++k)
            light += baked.patches.albedo[i][static_cast<int>(k)] * baked.lighting.planes[k][texel];
        flux += baked.patches.scene.patches[i].area * light / 3;
    }
    return flux;
}

} // namespace relume
