#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "assets/images/layered_exr.h"

namespace relume {

/// Another weight for a light's layer.
struct WeightEdit {
    std::string name;
    bool isFactor = false;          // on the intensity it has
    float intensity = 1.0f;         // in the light's unit
    std::optional<glm::vec3> color; // linear; none: as it is
};

/// The edit that "NAME=INTENSITY", "NAME=INTENSITY,COLOR" or "NAME*=FACTOR" means; COLOR as settingOf reads
/// it. Throws UsageError.
WeightEdit weightEditOf(std::string_view text);

struct MixDesc {
    std::vector<WeightEdit> edits; // in this order
    std::vector<std::string> muted, solo;
};

/// The lights that share a layer; empty: it is one light's.
std::vector<std::string> membersOf(const LayeredImage::Layer& layer);

/// What a layer's light has, by its attributes, else by its weight.
float intensityOf(const LayeredImage::Layer& layer);
glm::vec3 colorOf(const LayeredImage::Layer& layer);

/// Weighs the layers anew: first the edits, then switches; with solo only those shine, and muted ones never.
/// Then R, G and B of the composite are the sum of weight x layer; of its other channels only coverage stays.
/// Throws Error for names that no layer has, and for those of lights that share one.
void mixLayers(LayeredImage& image, const MixDesc& desc);

} // namespace relume
