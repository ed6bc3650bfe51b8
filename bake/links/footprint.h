#pragma once

#include "bake/links/patch_pyramid.h"
#include "bake/vk/buffer.h"
#include "bake/vk/program.h"

namespace relume {

/// Makes links read the light averaged over what their direction stands for, within the chart that it hits
/// [Colbert and Krivanek 2007]. Links then are indices into a radiance buffer that holds the nodes of a
/// PatchPyramid behind the patches. This is biased, by an amount that falls with the number of directions.
class Footprints {
public:
    /// Throws Error.
    Footprints(const vk::Device& device, const PatchSet& patches);

    /// Returns the bytes that LightBuffers::radiance then has: a vec4 per patch (padding included) and node.
    uint64_t radianceBytes() const { return (uint64_t{patchCount_} + nodeCount_) * sizeof(glm::vec4); }
    /// Makes what nodes send from what patches send. It sets the barriers between the levels; the caller sets
    /// those around it, here and below.
    void recordLevels(VkCommandBuffer cmd, const vk::Buffer& radiance) const;
    struct Work {
        VkDeviceAddress receivers = 0; // Patch[], where the links start
        VkDeviceAddress links = 0;     // uint[chunkCount][sampleCount][64], of patches as traced
        uint32_t firstChunk = 0, chunkCount = 0;
        uint32_t sampleCount = 0;
        uint32_t samples = 0; // per receiver in the whole result: each stands for pi / samples
    };
    /// Replaces patches by nodes in the links. `patches` is Patch[] of the scene.
    void recordLinks(VkCommandBuffer cmd, VkDeviceAddress patches, const Work& work) const;

    VkDeviceAddress nodes() const { return nodes_.address(); } // PyramidNode[]
    /// Returns the device bytes for so many patches and nodes, without those of radianceBytes().
    static uint64_t bytes(uint64_t patches, uint64_t nodes);
    uint32_t nodeCount() const { return nodeCount_; }

private:
    uint32_t patchCount_ = 0, nodeCount_ = 0;
    std::vector<uint32_t> levelEnds_;
    vk::Buffer nodes_, steps_;
    vk::ComputeProgram pyramid_, footprint_;
};

} // namespace relume
