#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "assets/model/scene.h"
#include "bake/surface/patch_set.h"

namespace relume {

class WorkerPool;

/// Returns a patch's albedo as a material makes it, not clamped; the reflectivity is counted in.
glm::vec4 albedoOf(const PatchSet& patches, size_t patch, const Material& material);
/// Tells whether such an albedo is clamped.
bool clamps(const PatchSet& patches, const glm::vec4& albedo);
/// Sets one patch's albedo from its material. Returns whether it had to be clamped.
bool applyBaseColor(PatchSet& patches, size_t patch, const Material& material);

/// Sets one patch's albedo and emission from its material. Returns whether the albedo had to be clamped.
bool applyMaterial(PatchSet& patches, size_t patch, const Material& material);

/// Sets all patches' albedo and emission to these factors times the patterns, on the pool or on this thread
/// alone.
void applyMaterials(PatchSet& patches, const std::vector<Material>& materials, WorkerPool* pool = nullptr);

} // namespace relume
