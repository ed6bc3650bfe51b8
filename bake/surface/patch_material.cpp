#include "bake/surface/patch_material.h"

#include <algorithm>

namespace relume {
namespace {

glm::vec4 albedoOf(const PatchSet& patches, size_t patch, const Material& material) {
    return material.baseColor * patches.albedoPattern[patch];
}

bool clamps(const PatchSet& patches, const glm::vec4& albedo) {
    return !patches.scene.rtrad && std::max({albedo.r, albedo.g, albedo.b}) > patches.maxAlbedo;
}

bool applyBaseColor(PatchSet& patches, size_t patch, const Material& material) {
    const glm::vec4 albedo = albedoOf(patches, patch, material);
    const bool clamped = clamps(patches, albedo);
    patches.albedo[patch] = clamped ? glm::min(albedo, glm::vec4(patches.maxAlbedo)) : albedo;
    return clamped;
}

} // namespace

bool applyMaterial(PatchSet& patches, size_t patch, const Material& material) {
    patches.emission[patch] = glm::vec4(material.emission, 0.0f) * patches.emissionPattern[patch];
    return applyBaseColor(patches, patch, material);
}

void applyMaterials(PatchSet& patches, const std::vector<Material>& materials) {
    const size_t count = patches.albedoPattern.size();
    std::vector<Material> all = materials;
    all.emplace_back(); // glTF's default material
    patches.albedo.resize(count);
    patches.emission.resize(count);
    patches.clampedAlbedo = 0;
    for (size_t i = 0; i < count; ++i) {
        if (applyMaterial(patches, i, all[patches.material[i]])) ++patches.clampedAlbedo;
    }
}

} // namespace relume
