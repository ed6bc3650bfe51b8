#pragma once

#include <vector>

#include "assets/model/scene.h"
#include "bake/surface/patch_set.h"

namespace relume {

/// Sets one patch's albedo and emission from its material. Returns whether the albedo had to be clamped.
bool applyMaterial(PatchSet& patches, size_t patch, const Material& material);

/// Sets all patches' albedo and emission to these factors times the patterns.
void applyMaterials(PatchSet& patches, const std::vector<Material>& materials);

} // namespace relume
