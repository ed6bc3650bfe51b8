#pragma once

#include <vector>

#include "assets/model/scene.h"
#include "bake/surface/patch_set.h"

namespace relume {

/// Albedo and emission of one patch by its material. Returns whether the albedo had to be made less.
bool applyMaterial(PatchSet& patches, size_t patch, const Material& material);

/// Sets albedo and emission to these factors times the patterns.
void applyMaterials(PatchSet& patches, const std::vector<Material>& materials);

} // namespace relume
