#pragma once

#include "bake/surface/patch_set.h"
#include "bake/vk/buffer.h"

namespace relume {

/// The texture group's patches on the device, as the passes read them: one entry per patch, padding included,
/// unless said otherwise. ligIn and ligOut hold lighting, irradiance / pi [cd/m^2]; in the RTRad preset
/// RTRad's radiosity.
struct LightBuffers {
    vk::Buffer patches;    // shader::Patch
    vk::Buffer edges;      // shader::PatchEdges
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

    static VkDeviceSize lightBytes(const PatchSet& set) {
        return set.scene.patches.size() * sizeof(glm::vec4);
    }
};

} // namespace relume
