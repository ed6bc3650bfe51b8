#pragma once

#include "assets/images/float_image.h"
#include "bake/surface/patches.h"

namespace relume {

class WorkerPool;

enum class Quantity {
    Lighting, // irradiance / pi, no albedo [cd/m^2]: what an engine multiplies with the albedo
    Radiance, // emission + reflectivity * albedo * lighting [cd/m^2]: RTRad's lig_out
};

struct LightmapDesc {
    Quantity quantity = Quantity::Lighting;
    float reflectivity = 1.0f;
    bool sew = true;
    uint32_t dilate = 4;        // rings of texels filled around charts
    bool rtrad = false;         // `light` holds RTRad's radiosity; one ring of the darkest neighbour
    WorkerPool* pool = nullptr; // where it is made; nullptr: on this thread alone
};

/// Scatters the patches' light [one vec4 each] to their texels and fills seams (SewSeams): texels beside a
/// chart, and those inside something, take the mean of their filled neighbours, ring by ring. The channels
/// are R, G, B and coverage: 1 a patch, 0.5 filled, 0 empty.
FloatImage makeLightmap(const PatchSet& patches, const std::vector<glm::vec4>& light,
                        const LightmapDesc& desc);

/// Throws Error where a texel of a lightmap is not finite: none is handed out so.
void requireFiniteTexels(const FloatImage& lightmap);

} // namespace relume
