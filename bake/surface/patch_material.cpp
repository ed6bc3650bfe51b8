#include "bake/surface/patch_material.h"

#include "assets/base/worker_pool.h"

#include <algorithm>
#include <atomic>

namespace relume {

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

bool applyMaterial(PatchSet& patches, size_t patch, const Material& material) {
    patches.emission[patch] = glm::vec4(material.emission, 0.0f) * patches.emissionPattern[patch];
    return applyBaseColor(patches, patch, material);
}

void applyMaterials(PatchSet& patches, const std::vector<Material>& materials, WorkerPool* pool) {
    constexpr size_t kPortion = 16384; // patches
    const size_t count = patches.albedoPattern.size();
    std::vector<Material> all = materials;
    all.emplace_back(); // glTF's default material
    patches.albedo.resize(count);
    patches.emission.resize(count);
    std::atomic<uint32_t> clamped{0};
    runWatched(pool, "patches", static_cast<uint32_t>((count + kPortion - 1) / kPortion),
               [&](uint32_t portion) {
                   uint32_t here = 0;
                   for (size_t i = portion * kPortion; i < std::min(count, (portion + 1) * kPortion); ++i)
                       here += applyMaterial(patches, i, all[patches.material[i]]);
                   clamped += here;
               });
    patches.clampedAlbedo = clamped;
}

} // namespace relume
