#pragma once

#include <cstdint>

#include "assets/atlas/unwrap_memory.h"
#include "assets/model/scene.h"

namespace relume {

struct UnwrapDesc {
    double density =
        0.0;             // [texels/m]; 0, or more than fits: what fills an atlas of `size` with all instances
    uint32_t size = 512; // of the atlas, of each page [texels]; 0: the least that takes the density
    bool onlyMissing = true; // leave meshes alone that have a valid set of lightmap UVs
    uint32_t threads = 0;    // 0: see WorkerPool
    uint32_t pages = 1;      // of the atlas, up to kMostPages; 0: as many as the density needs at `size`
};

struct UnwrapResult {
    uint32_t meshes = 0;       // that got new charts
    uint32_t objects = 0;      // instances in the atlas, those of kept UVs included
    uint32_t charts = 0;       // of all objects
    uint32_t stayed = 0;       // objects that lie where the unwrap before put them
    uint32_t size = 0;         // of the atlas, of each page [texels]
    uint32_t pages = 0;        // of the atlas
    double density = 0.0;      // [texels/m] used, for objects whose own factor is 1; 0: for none
    uint32_t shortened = 0;    // charts that are longer than the atlas, and so are shortened to it
    double leastDensity = 0.0; // [texels/m] that one of these has along itself; density where there are none
    uint32_t coarser = 0;      // objects that came or changed and got less than their density
    double leastShare = 1.0;   // of its density that one of these has
    double covered = 0.0;      // share of all pages' texels that charts touch
    double reserved = 0.0;     // share of these and of the gutters around them
};

/// Writes lightmap UVs into TEXCOORD_1, so that all instances form one atlas at one density, times the factor
/// of each instance: charts in their true shapes, see layOutCharts. An instance of a mesh that others share
/// gets a mesh of its own. Of several pages each instance lies on one, all its charts in 0 to 1 of that page
/// (Instance::page), and the pages are filled alike. Where a mesh has a valid set of UVs, this is kept as one
/// chart, which moves and is scaled to the density; where all meshes have one, the scene stays as it is.
/// Splits vertices where charts meet. Textures that read TEXCOORD_1 read another set from then on
/// (freeSecondSet()); a mesh whose textures need three sets is left alone and warned about. With a memory,
/// what did not change since the unwrap that left it stays where it is if all still fits, what came or
/// changed at half of its density at the least; then the memory is that of this unwrap. Throws Error where
/// there are more charts than texels, and for a density that would need absurdly many. Where nothing is cut,
/// the scene's pages stay what they are.
UnwrapResult unwrap(Scene& scene, const UnwrapDesc& desc, UnwrapMemory* memory = nullptr);

/// Throws Error for a scene of points and lines, which no lightmap UVs would help.
void requireArea(const Scene& scene);

/// Returns the area of all visible instances [m^2].
double surfaceArea(const Scene& scene);

/// Returns the edge of a lightmap, a power of two from 64 on and at most `maximum`, at which surfaces of
/// `area` [m^2] get `density` [texels/m] when charts cover the share `coverage` of it. With a `stride` it may
/// be a multiple of that instead, where one is smaller. Returns the least where there is no area or density,
/// and `maximum` where these are not finite or coverage is not above 0.
uint32_t sizeForDensity(double area, double density, double coverage, uint32_t maximum, uint32_t stride = 0);

} // namespace relume
