#include "bake/layers/layer_passes.h"

#include "bake/base/chunk_dispatch.h"

namespace relume {
namespace {

using shader::kChunk;

} // namespace

void LayerPass::recordDirect(VkCommandBuffer cmd, const LightBuffers& light, const DirectWork& work,
                             const Penumbra& penumbra) const {
    shader::LayerDirectPush push{.sums = work.sums.address(),
                                 .direct = work.direct.address(),
                                 .parts = penumbra.parts.address(),
                                 .penumbra = penumbra.lights.address(),
                                 .patchCount = light.chunkCount * kChunk,
                                 .scale = glm::vec2(0.0f),
                                 .share = glm::vec2(0.0f)};
    const uint32_t every[] = {shader::kPenumbraSamplePasses, 1};
    for (int i = 0; i < 2; ++i) {
        const auto taken = [&](uint32_t of) { return (of + every[i] - 1) / every[i]; };
        const uint32_t all = taken(work.before + work.added), added = all - taken(work.before);
        if (added == 0) continue;
        push.scale[i] = 1.0f / static_cast<float>(added);
        push.share[i] = static_cast<float>(added) / static_cast<float>(all);
    }
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

void LayerPass::recordSketch(VkCommandBuffer cmd, const LightBuffers& light, const vk::Buffer& sums,
                             const vk::Buffer& sketch) const {
    const shader::SketchPush push{.patches = light.patches.address(),
                                  .sums = sums.address(),
                                  .sketch = sketch.address(),
                                  .chunkCount = light.chunkCount};
    sketch_.dispatch(cmd, push, shader::kSketchStride, 1);
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
