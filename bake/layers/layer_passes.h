#pragma once

#include <span>
#include <vector>

#include "bake/direct/penumbra.h"
#include "bake/layers/layer.h"
#include "bake/surface/light_buffers.h"
#include "bake/vk/program.h"

namespace relume {

/// What sample passes that are added to direct light count, for patches outside penumbrae and within: the
/// factor from a replicate's sum to its mean, and their share among all; 0: there are none.
struct DirectShares {
    glm::vec2 scale{0.0f}, share{0.0f};
};
/// Returns them for `added` sample passes after the first `before`. The first two are added together.
DirectShares directShares(uint32_t before, uint32_t added);

/// Returns how many sample passes of direct light are taken together from this one on, in a step that ends
/// before `end`: each step has the same ones again where it is repaired.
uint32_t samplePassesTogether(uint32_t samplePass, uint32_t end);

/// Holds the kernels that treat layers as wholes. The caller sets the barriers.
class LayerPass {
public:
    explicit LayerPass(const vk::Device& device)
        : direct_(device, "layer_direct"), result_(device, "layer_result"), mix_(device, "layer_mix"),
          mixDirect_(device, "layer_mix_direct"), sketch_(device, "layer_sketch"),
          worth_(vk::ComputeProgram::builtAtFirstUse(device, "layer_worth")),
          local_(vk::ComputeProgram::builtAtFirstUse(device, "layer_local")) {}

    /// Direct light of a layer, and what is new of it.
    struct DirectWork {
        const vk::Buffer& direct; // of `before` sample passes, written
        const vk::Buffer& sums;   // of `added` new ones, vec4[kReplicates][patches]
        uint32_t before = 0, added = 0;
    };
    /// Takes new sample passes into direct light. penumbra is that of the layer, at least where it matters.
    void recordDirect(VkCommandBuffer cmd, const LightBuffers& light, const DirectWork& work,
                      const Penumbra& penumbra) const;
    /// Makes layer.result = layer.direct + indirect, and in chunkSums a vec4 per chunk: light, variance of
    /// the direct part, number of patches. indirect is laid out as result; nullptr stands for none.
    void recordResult(VkCommandBuffer cmd, const LightBuffers& light, const Layer& layer,
                      const vk::Buffer* indirect, const vk::Buffer& chunkSums) const;
    /// Makes a sketch (SketchPush) of sums over links, vec4[kReplicates][patches].
    void recordSketch(VkCommandBuffer cmd, const LightBuffers& light, const vk::Buffer& sums,
                      const vk::Buffer& sketch) const;
    /// Says how far off the composite is, patch by patch.
    struct LocalWork {
        const vk::Buffer& composite; // vec4 per patch, as recordMix makes it
        float deviation = 0;         // standard error over the composite's w
        float least = 0;             // what is darker is off relative to this [cd/m^2]
        uint32_t size = 0;           // edge of the lightmap [texels]
    };
    /// Counts texels in bins, which it clears, by how far they and those next to them are off, or by their
    /// light where the deviation is 0, and makes in chunkSums what LayerLocalPush says.
    void recordLocal(VkCommandBuffer cmd, const LightBuffers& light, const LocalWork& work,
                     const vk::Buffer& bins, const vk::Buffer& chunkSums) const;
    /// Says what is asked of it, too.
    struct WorthWork {
        LocalWork local;
        float aim = 0; // local error that 95 % of all texels are to come within
    };
    /// Makes in chunkSums a vec4 per chunk: variance of the layer's direct and of its indirect light, each
    /// patch by what it is worth for the local error (lib/local_error.glsl), and both as they are.
    void recordWorth(VkCommandBuffer cmd, const LightBuffers& light, const Layer& layer,
                     const WorthWork& work, const vk::Buffer& chunkSums) const;
    /// Makes light = base + the sum of weights (LayerWeight[count]) times layers. base is nullptr for
    /// nothing.
    void recordMix(VkCommandBuffer cmd, const vk::Buffer& weights, uint32_t count, const vk::Buffer* base,
                   const vk::Buffer& light) const;
    /// Does the same with direct light: weights are of layers' direct, and so is what is written.
    void recordMixDirect(VkCommandBuffer cmd, const vk::Buffer& weights, uint32_t count,
                         const vk::Buffer& direct) const;

private:
    vk::ComputeProgram direct_, result_, mix_, mixDirect_, sketch_, worth_, local_;
};

} // namespace relume
