#pragma once

#include <vector>

#include "bake/surface/patches.h"

namespace relume {

using PatchLight = std::vector<glm::vec4>; // of every patch, padding included; a means nothing

/// How far light is from a reference, over R, G and B of the patches that receive light and are shown;
/// infinite where only the reference is black.
struct LightDifference {
    double relRmse = 0; // rmse / mean of the reference
    double maximum = 0; // of the differences, relative to that mean
};
/// Compares scale * light with the reference.
LightDifference compareLight(const PatchSet& patches, const PatchLight& light, const PatchLight& reference,
                             const glm::vec3& scale = glm::vec3(1.0f));

} // namespace relume
