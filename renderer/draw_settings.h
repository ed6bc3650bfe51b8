#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "renderer/shader_types.h"

namespace relume {

/// What is drawn of a scene; shaders/lib/scene_material.glsl says more.
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
    // Of a quantity that the lightmap's texture holds in place of light, in RGB:
    InspectColor = shader::kViewInspectColor,       // light: ligIn, ligOut, their mips
    InspectRaw = shader::kViewInspectRaw,           // as displayed
    InspectPosition = shader::kViewInspectPosition, // as a share of DrawSettings' range
    InspectNormal = shader::kViewInspectNormal,
    // R on a scale of colours over the range's x:
    InspectHeat = shader::kViewInspectHeat,
    // Quad-tree: R log2 of a leaf's edge in texels, G 1 along its border, B in [0, 1) tells it from
    // neighbours:
    InspectLeaves = shader::kViewInspectLeaves,
    // R 1 seen or 0 not, G form factor, of the largest one, B 1 where it is seen from:
    InspectMask = shader::kViewInspectMask,
};

enum class LightmapFilter : uint32_t {
    Nearest = shader::kFilterNearest,
    Bilinear = shader::kFilterBilinear,
    Bicubic = shader::kFilterBicubic,
};

enum class ToneMap : uint32_t { None = shader::kToneNone, Aces = shader::kToneAces, Agx = shader::kToneAgx };

/// By number, as users write them: "lit", "bilinear", "agx". Views only up to Coverage: the others need a
/// baker that tells quantities.
const std::vector<std::string>& viewNames();
const std::vector<std::string>& filterNames();
const std::vector<std::string>& toneNames();

/// Views of light are exposed and tone mapped, the others are colours that mean something as they are.
bool showsLight(View view);
/// Whether a view differs with what the lightmap holds.
bool readsLightmap(View view);

struct DrawSettings {
    View view = View::Lit;
    LightmapFilter filter = LightmapFilter::Bilinear;
    ToneMap tone = ToneMap::Agx;
    std::optional<float> exposure; // [EV]: light counts 2^exposure times; none: what the picture asks for
    glm::vec3 background{0.11f, 0.12f, 0.13f}; // as displayed (sRGB)
    glm::vec3 rangeLow{0.0f},
        rangeHigh{1.0f};   // InspectPosition and InspectHeat: from one end of the scale to the other
    int32_t selected = -1; // instance that is tinted, -1: none

    bool operator==(const DrawSettings&) const = default;
};

} // namespace relume
