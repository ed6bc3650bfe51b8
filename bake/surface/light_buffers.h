#pragma once

#include <utility>

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
    uint32_t chunkCount = 0;

    LightBuffers(const vk::Device& device, const PatchSet& set)
        : patches(vk::makeBuffer(device, set.scene.patches, "patches")),
          edges(vk::makeBuffer(device, set.edges, "edges")),
          bounds(vk::makeBuffer(device, set.bounds, "chunk bounds")),
          albedo(vk::makeBuffer(device, set.albedo, "albedo")),
          emission(vk::makeBuffer(device, set.emission, "emission")),
          radiance(device, {.size = lightBytes(set), .name = "radiance"}),
          chunkSends(device, {.size = set.chunkCount() * sizeof(uint32_t), .name = "chunk sends"}),
          ligIn(device, {.size = lightBytes(set), .name = "ligIn"}),
          ligOut(device, {.size = lightBytes(set), .name = "ligOut"}), chunkCount(set.chunkCount()) {}

    /// Makes radiance as large as a solver needs it, which may have more places than there are patches. What
    /// was in it is lost where the size changes. The old one stays until the new one is there.
    void resizeRadiance(const vk::Device& device, VkDeviceSize bytes) {
        if (radiance.size() != bytes) radiance = vk::Buffer(device, {.size = bytes, .name = "radiance"});
    }
    /// Returns the covers for samples that start all over their texels, nullptr for those that do not.
    const vk::Buffer* coversIf(bool allOver) const { return allOver && covers ? &covers : nullptr; }
    /// Makes what was gathered what the next bounce starts from.
    void turn() { std::swap(ligIn, ligOut); }

    /// Returns their bytes for patches in so many chunks, with covers or without.
    static uint64_t bytes(uint32_t chunks, bool withCovers) {
        constexpr uint64_t kLight = 5 * sizeof(glm::vec4); // albedo, emission, radiance, ligIn, ligOut
        constexpr uint64_t kWhole = 16;                    // devices make buffers multiples of so many bytes
        const auto ofChunks = [&](uint64_t each) { return (chunks * each + kWhole - 1) / kWhole * kWhole; };
        return ofChunks(shader::kChunk * (sizeof(shader::Patch) + sizeof(shader::PatchEdges) + kLight +
                                          (withCovers ? sizeof(shader::PatchCover) : 0))) +
               ofChunks(sizeof(shader::ChunkBounds)) + ofChunks(sizeof(uint32_t));
    }
    static VkDeviceSize lightBytes(const PatchSet& set) {
        return set.scene.patches.size() * sizeof(glm::vec4);
    }
};

} // namespace relume
