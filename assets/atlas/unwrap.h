#pragma once

#include <cstdint>

#include "assets/model/scene.h"

namespace relume {

struct UnwrapDesc {
    double density = 0.0;    // [texels/m]; 0: what fills an atlas of `size` with all instances
    uint32_t size = 512;     // [texels], of the atlas the density 0 aims at
    bool onlyMissing = true; // leave meshes alone that have a valid set of lightmap UVs
};

struct UnwrapResult {
    uint32_t meshes = 0;  // that got new UVs
    uint32_t charts = 0;  // of these
    double density = 0.0; // [texels/m] used; 0: for none
};

/// Writes lightmap UVs into TEXCOORD_1 of the scene's meshes: planar charts with 2 texels between them at the
/// density, one square per mesh, shared by its instances. The result is a valid atlas for every mesh that has
/// a triangle with an area. Splits vertices where charts meet. Throws Error for a density that would need
/// absurdly many texels.
UnwrapResult unwrap(Scene& scene, const UnwrapDesc& desc);

/// Throws Error for a scene of points and lines, which no lightmap UVs would help.
void requireArea(const Scene& scene);

} // namespace relume
