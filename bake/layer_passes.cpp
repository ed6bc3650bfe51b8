#include "bake/layer_passes.h"

#include "bake/chunk_dispatch.h"

namespace relume {
namespace {

using shader::kChunk;

} // namespace

void LayerPass::recordDirect(VkCommandBuffer cmd, const LightBuffers& light, const Layer& layer,
                             const vk::Buffer& sums, uint32_t rounds) const {
    const auto added = static_cast<float>(rounds);
    const shader::LayerDirectPush push{.sums = sums.address(),
                                       .direct = layer.direct->address(),
                                       .patchCount = light.chunkCount * kChunk,
                                       .scale = 1.0f / added,
                                       .share = added / static_cast<float>(layer.directRounds + rounds)};
    dispatchChunks(direct_, cmd, push, light.chunkCount);
}

void LayerPass::recordResult(VkCommandBuffer cmd, const LightBuffers& light, const Layer& layer,
                             const vk::Buffer* indirect, const vk::Buffer& chunkSums) const {
    const shader::LayerResultPush push{.patches = light.patches.address(),
                                       .direct = layer.direct->address(),
                                       .indirect = indirect ? indirect->address() : 0,
                                       .result = layer.result.address(),
                                       .chunkSums = chunkSums.address(),
                                       .chunkCount = light.chunkCount};
    dispatchChunks(result_, cmd, push, light.chunkCount);
}

void LayerPass::recordMix(VkCommandBuffer cmd, const vk::Buffer& weights, uint32_t count,
                          const vk::Buffer* base, const vk::Buffer& light) const {
    const auto patches = static_cast<uint32_t>(light.size() / sizeof(glm::vec4));
    const shader::LayerMixPush push{.layers = weights.address(),
                                    .base = base ? base->address() : 0,
                                    .light = light.address(),
                                    .layerCount = count,
                                    .patchCount = patches};
    dispatchChunks(mix_, cmd, push, patches / kChunk);
}

void LayerPass::recordMixDirect(VkCommandBuffer cmd, const vk::Buffer& weights, uint32_t count,
                                const vk::Buffer& direct) const {
    const auto patches = static_cast<uint32_t>(direct.size() / sizeof(glm::vec4));
    const shader::LayerMixPush push{
        .layers = weights.address(), .light = direct.address(), .layerCount = count, .patchCount = patches};
    dispatchChunks(mixDirect_, cmd, push, patches / kChunk);
}

} // namespace relume
