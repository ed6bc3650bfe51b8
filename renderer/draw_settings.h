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
};

enum class LightmapFilter : uint32_t {
    Nearest = shader::kFilterNearest,
    Bilinear = shader::kFilterBilinear,
    Bicubic = shader::kFilterBicubic,
};

enum class ToneMap : uint32_t { None = shader::kToneNone, Aces = shader::kToneAces, Agx = shader::kToneAgx };

/// By number, as users write them: "lit", "bilinear", "agx".
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
};

} // namespace relume
