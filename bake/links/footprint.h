#pragma once

#include "bake/links/patch_pyramid.h"
#include "bake/vk/buffer.h"
#include "bake/vk/program.h"

namespace relume {

/// Links that read the light averaged over what their direction stands for, within the chart that it hits
/// [Colbert and Krivanek 2007]. Links then are indices into a radiance buffer that holds the nodes of a
/// PatchPyramid behind the patches. Biased, by an amount that falls with the number of directions.
class Footprints {
public:
    /// Throws Error.
    Footprints(const vk::Device& device, const PatchSet& patches);

    /// vec4 per patch, padding included, and node: takes the place of LightBuffers::radiance.
    vk::Buffer makeRadiance(const vk::Device& device) const;
    /// What nodes send, of what patches send. Barriers between the levels are its own, those around it the
    /// caller's, here and below.
    void recordLevels(VkCommandBuffer cmd, const vk::Buffer& radiance) const;
    struct Work {
        VkDeviceAddress receivers = 0; // Patch[], where the links start
        VkDeviceAddress links = 0;     // uint[chunkCount][sampleCount][64], of patches as traced
        uint32_t firstChunk = 0, chunkCount = 0;
        uint32_t sampleCount = 0;
        uint32_t samples = 0; // of each receiver that the result is of: each stands for pi / samples
    };
    /// Replaces patches by nodes. patches: Patch[] of the scene.
    void recordLinks(VkCommandBuffer cmd, VkDeviceAddress patches, const Work& work) const;

    VkDeviceAddress nodes() const { return nodes_.address(); } // PyramidNode[]
    /// Device bytes for so many patches, at most.
    static uint64_t bytes(uint64_t patchCount);

private:
    uint32_t patchCount_ = 0, nodeCount_ = 0;
    std::vector<uint32_t> levelEnds_;
    vk::Buffer nodes_, steps_;
    vk::ComputeProgram pyramid_, footprint_;
};

} // namespace relume
