#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "renderer/shader_types.h"

namespace relume {

/// Says what is drawn of a scene; shaders/lib/scene_material.glsl says more.
enum class View : uint32_t {
    Lit = shader::kViewLit,
    Lighting = shader::kViewLighting,
    Albedo = shader::kViewAlbedo,
    Emission = shader::kViewEmission,
    Normal = shader::kViewNormal,
    Material = shader::kViewMaterial,
    Instance = shader::kViewInstance,
    Checker = shader::kViewChecker,
    Density = shader::kViewDensity,
    Coverage = shader::kViewCoverage,
    // The views below show a quantity that the lightmap's texture holds in place of light. These have it in
    // RGB:
    InspectColor = shader::kViewInspectColor,       // light: ligIn, ligOut, their mips
    InspectRaw = shader::kViewInspectRaw,           // as displayed
    InspectPosition = shader::kViewInspectPosition, // as a share of DrawSettings' range
    InspectNormal = shader::kViewInspectNormal,
    // This shows R on a scale of colours over the range's x:
    InspectHeat = shader::kViewInspectHeat,
    // This shows the quad-tree: R is log2 of a leaf's edge in texels, G is 1 along its border, B in [0, 1)
    // tells it from neighbours:
    InspectLeaves = shader::kViewInspectLeaves,
    // This shows what is seen: R is 1 if seen and 0 if not, G is the form factor as a share of the largest
    // one, B is 1 where it is seen from:
    InspectMask = shader::kViewInspectMask,
};

enum class LightmapFilter : uint32_t {
    Nearest = shader::kFilterNearest,
    Bilinear = shader::kFilterBilinear,
    Bicubic = shader::kFilterBicubic,
};

enum class ToneMap : uint32_t { None = shader::kToneNone, Aces = shader::kToneAces, Agx = shader::kToneAgx };

/// Return the names by number, as users write them: "lit", "bilinear", "agx". Views go only up to Coverage:
/// the others need a baker that tells quantities.
const std::vector<std::string>& viewNames();
const std::vector<std::string>& filterNames();
const std::vector<std::string>& toneNames();

/// Tells whether a view shows light: such views are exposed and tone mapped, the others are colours that mean
/// something as they are.
bool showsLight(View view);
/// Tells whether a view depends on what the lightmap holds.
bool readsLightmap(View view);

struct DrawSettings {
    View view = View::Lit;
    LightmapFilter filter = LightmapFilter::Bilinear;
    ToneMap tone = ToneMap::Agx;
    std::optional<float> exposure; // [EV]: light counts 2^exposure times; none: what the picture asks for
    bool dither = true;            // light is dithered to the picture's 8 bits, so that it shows no contours
    glm::vec3 background{0.11f, 0.12f, 0.13f}; // as displayed (sRGB)
    glm::vec3 rangeLow{0.0f},
        rangeHigh{1.0f};   // InspectPosition and InspectHeat: from one end of the scale to the other
    int32_t selected = -1; // instance that is tinted, -1: none

    bool operator==(const DrawSettings&) const = default;
};

} // namespace relume
