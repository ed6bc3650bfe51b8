#include "bake/surface_colours.h"

#include <algorithm>
#include <numeric>

namespace relume {
namespace {

// Patches that go to the device together: 256 KiB, which take no longer to copy than to ask for.
constexpr size_t kBlock = 16384;

void upload(const vk::Device& device, const vk::Buffer& buffer, const std::vector<glm::vec4>& values,
            const std::vector<uint8_t>& dirty) {
    for (size_t block = 0; block < dirty.size();) {
        size_t end = block;
        while (end < dirty.size() && dirty[end] != 0)
            ++end;
        if (end > block) {
            const size_t first = block * kBlock, count = std::min(end * kBlock, values.size()) - first;
            vk::upload(device, buffer, &values[first], count * sizeof(glm::vec4), first * sizeof(glm::vec4));
        }
        block = end + 1;
    }
}

glm::vec4 albedoOf(const PatchSet& patches, size_t patch, const Material& material) {
    return material.baseColor * patches.albedoPattern[patch];
}

bool clamps(const PatchSet& patches, const glm::vec4& albedo) {
    return !patches.scene.rtrad && std::max({albedo.r, albedo.g, albedo.b}) > patches.maxAlbedo;
}

} // namespace

bool applyMaterial(PatchSet& patches, size_t patch, const Material& material) {
    const glm::vec4 albedo = albedoOf(patches, patch, material);
    const bool clamped = clamps(patches, albedo);
    patches.albedo[patch] = clamped ? glm::min(albedo, glm::vec4(patches.maxAlbedo)) : albedo;
    patches.emission[patch] = glm::vec4(material.emission, 0.0f) * patches.emissionPattern[patch];
    return clamped;
}

SurfaceColours::SurfaceColours(std::vector<Material> materials) : applied_(std::move(materials)) {
    applied_.emplace_back();
}

std::vector<SurfaceColours::Changed> SurfaceColours::changesTo(const std::vector<Material>& materials) const {
    ASSERT(materials.size() == applied_.size());
    std::vector<Changed> changed(materials.size());
    for (size_t i = 0; i < materials.size(); ++i)
        changed[i] = {materials[i].baseColor != applied_[i].baseColor,
                      materials[i].emission != applied_[i].emission};
    return changed;
}

// Returns whether any of its patches is another now; clamped: how many more have their albedo made less.
bool SurfaceColours::updateBlock(const std::vector<Material>& materials, const std::vector<Changed>& changed,
                                 PatchSet& patches, size_t block, int64_t& clamped) const {
    bool dirty = false;
    clamped = 0;
    const size_t end = std::min((block + 1) * kBlock, patches.material.size());
    for (size_t i = block * kBlock; i < end; ++i) {
        const uint32_t material = patches.material[i];
        if (!changed[material].albedo && !changed[material].emission) continue;
        dirty = true;
        clamped -= clamps(patches, albedoOf(patches, i, applied_[material])) ? 1 : 0;
        clamped += applyMaterial(patches, i, materials[material]) ? 1 : 0;
    }
    return dirty;
}

void SurfaceColours::update(const vk::Device& device, const std::vector<Material>& materials,
                            PatchSet& patches, LightBuffers& light) {
    std::vector<Material> now = materials;
    now.emplace_back();
    const std::vector<Changed> changed = changesTo(now);
    const bool albedo = std::any_of(changed.begin(), changed.end(), [](Changed c) { return c.albedo; });
    const bool emission = std::any_of(changed.begin(), changed.end(), [](Changed c) { return c.emission; });
    if (!albedo && !emission) return;
    if (!pool_) pool_ = std::make_unique<WorkerPool>(0);
    std::vector<uint8_t> dirty((patches.material.size() + kBlock - 1) / kBlock);
    std::vector<int64_t> clamped(dirty.size());
    pool_->run(static_cast<uint32_t>(dirty.size()), [&](uint32_t block) {
        dirty[block] = updateBlock(now, changed, patches, block, clamped[block]) ? 1 : 0;
    });
    const int64_t more = std::accumulate(clamped.begin(), clamped.end(), int64_t{0});
    patches.clampedAlbedo = static_cast<uint32_t>(patches.clampedAlbedo + more);
    if (albedo) upload(device, light.albedo, patches.albedo, dirty);
    if (emission) upload(device, light.emission, patches.emission, dirty);
    applied_ = std::move(now);
}

void SurfaceColours::updateAll(const vk::Device& device, const std::vector<Material>& materials,
                               PatchSet& patches, LightBuffers& light) {
    applyMaterials(patches, materials);
    vk::upload(device, light.albedo, patches.albedo.data(), patches.albedo.size() * sizeof(glm::vec4));
    vk::upload(device, light.emission, patches.emission.data(), patches.emission.size() * sizeof(glm::vec4));
    *this = SurfaceColours(materials);
}

} // namespace relume
