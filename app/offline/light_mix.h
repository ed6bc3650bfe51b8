#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "assets/images/layered_exr.h"

namespace relume {

/// An edit that gives a light's layer another weight.
struct WeightEdit {
    std::string name;
    bool isFactor = false;          // the number is a factor of the intensity that the light has
    float intensity = 1.0f;         // in the light's unit
    std::optional<glm::vec3> color; // linear; none: it stays as it is
};

/// Returns the edit that "NAME=INTENSITY", "NAME=INTENSITY,COLOR" or "NAME*=FACTOR" means; settingOf reads
/// COLOR. Throws UsageError.
WeightEdit weightEditOf(std::string_view text);

struct MixDesc {
    std::vector<WeightEdit> edits; // in this order
    std::vector<std::string> muted, solo;
};

/// Returns the lights that share a layer; empty: it is one light's.
std::vector<std::string> membersOf(const LayeredImage::Layer& layer);

/// Return what a layer's light has by its attributes, else by its weight.
float intensityOf(const LayeredImage::Layer& layer);
glm::vec3 colorOf(const LayeredImage::Layer& layer);

/// Weighs the layers anew, first by the edits, then by the switches: with solo only those shine, and muted
/// ones never. Then R, G and B of the composite are the sum of weight x layer; of its other channels only
/// coverage stays. Throws Error for names that no layer has, and for those of lights that share one.
void mixLayers(LayeredImage& image, const MixDesc& desc);

} // namespace relume
