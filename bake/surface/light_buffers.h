#pragma once

#include <utility>

#include "bake/base/spill.h"
#include "bake/surface/patch_set.h"
#include "bake/vk/buffer.h"

namespace relume {

/// The texture group's patches on the device, as the passes read them: one entry per patch, padding included,
/// unless said otherwise. ligIn and ligOut hold lighting, irradiance / pi [cd/m^2]; in the RTRad preset
/// RTRad's radiosity.
struct LightBuffers {
    vk::Buffer patches;    // shader::Patch
    vk::Buffer edges;      // shader::PatchEdges
    vk::Buffer covers;     // shader::PatchCover; only where samples start all over their texels
    vk::Buffer bounds;     // shader::ChunkBounds, per chunk
    vk::Buffer albedo;     // vec4
    vk::Buffer emission;   // vec4 [cd/m^2]
    vk::Buffer radiance;   // vec4 [cd/m^2], what each patch sends in this pass
    vk::Buffer chunkSends; // uint per chunk: whether anything in it sends in this pass
    vk::Buffer ligIn;      // vec4
    vk::Buffer ligOut;     // vec4
    vk::Memory memory = vk::Memory::Device; // of what the host may hold: all but patches, covers and chunks'
    uint32_t chunkCount = 0;

    LightBuffers(const vk::Device& device, const PatchSet& set, Spill spill = Spill::None)
        : patches(vk::makeBuffer(device, set.scene.patches, "patches")),
          bounds(vk::makeBuffer(device, set.bounds, "chunk bounds")),
          chunkSends(device, {.size = set.chunkCount() * sizeof(uint32_t), .name = "chunk sends"}),
          memory(memoryFrom(Spill::Light, spill)), chunkCount(set.chunkCount()) {
        edges = vk::makeBuffer(device, set.edges, "edges", 0, memory);
        albedo = vk::makeBuffer(device, set.albedo, "albedo", 0, memory);
        emission = vk::makeBuffer(device, set.emission, "emission", 0, memory);
        radiance = lightBuffer(device, lightBytes(set), "radiance");
        ligIn = lightBuffer(device, lightBytes(set), "ligIn");
        ligOut = lightBuffer(device, lightBytes(set), "ligOut");
    }

    /// Makes radiance as large as a solver needs it, which may have more places than there are patches. What
    /// was in it is lost where the size changes. The old one stays until the new one is there.
    void resizeRadiance(const vk::Device& device, VkDeviceSize bytes) {
        if (radiance.size() != bytes) radiance = lightBuffer(device, bytes, "radiance");
    }
    /// Returns the covers for samples that start all over their texels, nullptr for those that do not.
    const vk::Buffer* coversIf(bool allOver) const { return allOver && covers ? &covers : nullptr; }
    /// Makes what was gathered what the next bounce starts from.
    void turn() { std::swap(ligIn, ligOut); }

    /// Returns their bytes for patches in so many chunks, with covers or without.
    static SpilledBytes bytes(uint32_t chunks, bool withCovers, Spill spill) {
        constexpr uint64_t kLight = 5 * sizeof(glm::vec4); // albedo, emission, radiance, ligIn, ligOut
        constexpr uint64_t kWhole = 16;                    // devices make buffers multiples of so many bytes
        const auto ofChunks = [&](uint64_t each) { return (chunks * each + kWhole - 1) / kWhole * kWhole; };
        SpilledBytes bytes;
        bytes.device = ofChunks(shader::kChunk *
                                (sizeof(shader::Patch) + (withCovers ? sizeof(shader::PatchCover) : 0))) +
                       ofChunks(sizeof(shader::ChunkBounds)) + ofChunks(sizeof(uint32_t));
        bytes.add(ofChunks(shader::kChunk * (sizeof(shader::PatchEdges) + kLight)), Spill::Light, spill);
        return bytes;
    }
    static VkDeviceSize lightBytes(const PatchSet& set) {
        return set.scene.patches.size() * sizeof(glm::vec4);
    }

private:
    vk::Buffer lightBuffer(const vk::Device& device, VkDeviceSize bytes, const char* name) const {
        return {device, {.size = bytes, .memory = memory, .name = name}};
    }
};

} // namespace relume
