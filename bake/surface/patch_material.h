#pragma once

#include <vector>

#include "assets/model/scene.h"
#include "bake/surface/patch_set.h"

namespace relume {

class WorkerPool;

/// Sets one patch's albedo and emission from its material. Returns whether the albedo had to be clamped.
bool applyMaterial(PatchSet& patches, size_t patch, const Material& material);

/// Sets all patches' albedo and emission to these factors times the patterns, on the pool or on this thread
/// alone.
void applyMaterials(PatchSet& patches, const std::vector<Material>& materials, WorkerPool* pool = nullptr);

} // namespace relume
