#pragma once

#include <span>
#include <vector>

#include "bake/direct/penumbra.h"
#include "bake/layers/layer.h"
#include "bake/surface/light_buffers.h"
#include "bake/vk/program.h"

namespace relume {

/// What is done to layers as wholes. Barriers are the caller's.
class LayerPass {
public:
    explicit LayerPass(const vk::Device& device)
        : direct_(device, "layer_direct"), result_(device, "layer_result"), mix_(device, "layer_mix"),
          mixDirect_(device, "layer_mix_direct") {}

    /// Takes the sums of `rounds` new rounds, vec4[kReplicates][patches], into layer.direct, which holds
    /// layer.directRounds of them. penumbra: that of the layer, at least where it matters.
    void recordDirect(VkCommandBuffer cmd, const LightBuffers& light, const Layer& layer,
                      const vk::Buffer& sums, const Penumbra& penumbra, uint32_t rounds) const;
    /// layer.result = layer.direct + indirect; vec4 per chunk in chunkSums: light, variance of the direct
    /// part, number of patches. indirect: as result; nullptr: none.
    void recordResult(VkCommandBuffer cmd, const LightBuffers& light, const Layer& layer,
                      const vk::Buffer* indirect, const vk::Buffer& chunkSums) const;
    /// light = base + the sum of weights (LayerWeight[count]) times layers. base: nullptr for nothing.
    void recordMix(VkCommandBuffer cmd, const vk::Buffer& weights, uint32_t count, const vk::Buffer* base,
                   const vk::Buffer& light) const;
    /// The same of direct light: weights are of layers' direct, and so is what is written.
    void recordMixDirect(VkCommandBuffer cmd, const vk::Buffer& weights, uint32_t count,
                         const vk::Buffer& direct) const;

private:
    vk::ComputeProgram direct_, result_, mix_, mixDirect_;
};

} // namespace relume
