#include "bake/surface/surface_colours.h"

#include "bake/base/chunk_dispatch.h"
#include "bake/base/retrace_types.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace relume {
namespace {

// So many patches go to the device together: their 256 KiB take no longer to copy than to ask for.
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

} // namespace

SurfaceColours::OnDevice::OnDevice(const vk::Device& device, const PatchSet& patches, size_t materialCount)
    : materials(vk::makeBuffer(device, patches.material, "materials of patches")),
      pattern(vk::makeBuffer(device, patches.albedoPattern, "albedo pattern")),
      baseColors(
          device,
          {.size = materialCount * sizeof(glm::vec4), .memory = vk::Memory::Host, .name = "base colours"}),
      recolour(device, "recolour"), commands(device) {}

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

// Updates a block of patches and returns whether any of them shines otherwise now; `clamped` gets how many
// more have their albedo clamped.
bool SurfaceColours::updateBlock(const std::vector<Material>& materials, const std::vector<Changed>& changed,
                                 PatchSet& patches, size_t block, int64_t& clamped) const {
    bool dirty = false;
    clamped = 0;
    const size_t end = std::min((block + 1) * kBlock, patches.material.size());
    for (size_t i = block * kBlock; i < end; ++i) {
        const uint32_t material = patches.material[i];
        if (changed[material].emission) {
            dirty = true;
            patches.emission[i] = glm::vec4(materials[material].emission, 0.0f) * patches.emissionPattern[i];
        }
        if (!changed[material].albedo) continue;
        clamped -= clamps(patches, albedoOf(patches, i, applied_[material])) ? 1 : 0;
        clamped += applyBaseColor(patches, i, materials[material]) ? 1 : 0;
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
    std::vector<uint8_t> dirty((patches.material.size() + kBlock - 1) / kBlock);
    std::vector<int64_t> clamped(dirty.size());
    device.workers().run(static_cast<uint32_t>(dirty.size()), [&](uint32_t block) {
        dirty[block] = updateBlock(now, changed, patches, block, clamped[block]) ? 1 : 0;
    });
    const int64_t more = std::accumulate(clamped.begin(), clamped.end(), int64_t{0});
    patches.clampedAlbedo = static_cast<uint32_t>(patches.clampedAlbedo + more);
    if (albedo) recolour(device, now, changed, patches, light);
    if (emission) upload(device, light.emission, patches.emission, dirty);
    applied_ = std::move(now);
}

// Does on the device what applyBaseColor does on the host.
void SurfaceColours::recolour(const vk::Device& device, const std::vector<Material>& materials,
                              const std::vector<Changed>& changed, const PatchSet& patches,
                              const LightBuffers& light) {
    if (!onDevice_) onDevice_ = std::make_unique<OnDevice>(device, patches, materials.size());
    auto* baseColors = onDevice_->baseColors.as<glm::vec4>();
    for (size_t i = 0; i < materials.size(); ++i) {
        baseColors[i] = materials[i].baseColor;
        if (!changed[i].albedo) baseColors[i].a = -1.0f;
    }
    const bool clamps = !patches.scene.rtrad;
    const shader::RecolourPush push{.materials = onDevice_->materials.address(),
                                    .baseColors = onDevice_->baseColors.address(),
                                    .pattern = onDevice_->pattern.address(),
                                    .albedo = light.albedo.address(),
                                    .patchCount = light.chunkCount * shader::kChunk,
                                    .maxAlbedo =
                                        clamps ? patches.maxAlbedo : std::numeric_limits<float>::max()};
    VkCommandBuffer cmd = onDevice_->commands.begin();
    vk::barrier(cmd); // earlier work may still read the albedo
    dispatchChunks(onDevice_->recolour, cmd, push, light.chunkCount);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    onDevice_->commands.run();
}

void SurfaceColours::updateAll(const vk::Device& device, const std::vector<Material>& materials,
                               PatchSet& patches, LightBuffers& light) {
    applyMaterials(patches, materials, &device.workers());
    vk::upload(device, light.albedo, patches.albedo.data(), patches.albedo.size() * sizeof(glm::vec4));
    vk::upload(device, light.emission, patches.emission.data(), patches.emission.size() * sizeof(glm::vec4));
    *this = SurfaceColours(materials);
}

} // namespace relume
