#include "bake/layers/layer_passes.h"

#include "bake/base/chunk_dispatch.h"

namespace relume {
namespace {

using shader::kChunk;

// Counts the sample passes before `end` that patches outside penumbrae take.
uint32_t takenByAll(uint32_t end) {
    uint32_t count = 0;
    for (uint32_t samplePass = 0; samplePass < end; ++samplePass)
        count += shader::allTakeSamplePass(samplePass) ? 1 : 0;
    return count;
}

} // namespace

DirectShares directShares(uint32_t before, uint32_t added) {
    // The first sample pass says where penumbrae are, so what it says of patches outside would be chosen by
    // itself: it counts there only as long as there is no other.
    const auto outside = [](uint32_t end) {
        const uint32_t taken = takenByAll(end);
        return taken > 1 ? taken - 1 : taken;
    };
    const bool forgets = takenByAll(before) == 1 && takenByAll(before + added) > 1;
    const uint32_t all[] = {outside(before + added), before + added};
    const uint32_t of[] = {forgets ? all[0] : all[0] - outside(before), added};
    DirectShares shares;
    for (int i = 0; i < 2; ++i) {
        if (of[i] == 0) continue;
        shares.scale[i] = 1.0f / static_cast<float>(of[i]);
        shares.share[i] = static_cast<float>(of[i]) / static_cast<float>(all[i]);
    }
    return shares;
}

uint32_t samplePassesTogether(uint32_t samplePass, uint32_t end) {
    constexpr uint32_t kMost = shader::kSamplePassesTogether;
    const bool begins = samplePass >= kMost && samplePass % kMost == 0;
    return begins && samplePass + kMost <= end ? kMost : 1;
}

void LayerPass::recordDirect(VkCommandBuffer cmd, const LightBuffers& light, const DirectWork& work,
                             const Penumbra& penumbra) const {
    const DirectShares shares = directShares(work.before, work.added);
    const shader::LayerDirectPush push{.sums = work.sums.address(),
                                       .direct = work.direct.address(),
                                       .parts = penumbra.parts.address(),
                                       .penumbra = penumbra.lights.address(),
                                       .patchCount = light.chunkCount * kChunk,
                                       .scale = shares.scale,
                                       .share = shares.share};
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

void LayerPass::recordLocal(VkCommandBuffer cmd, const LightBuffers& light, const LocalWork& work,
                            const vk::Buffer& bins, const vk::Buffer& chunkSums) const {
    vkCmdFillBuffer(cmd, bins.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    const shader::LayerLocalPush push{.patches = light.patches.address(),
                                      .composite = work.composite.address(),
                                      .bins = bins.address(),
                                      .chunkSums = chunkSums.address(),
                                      .deviation = work.deviation,
                                      .least = work.least,
                                      .chunkCount = light.chunkCount,
                                      .size = work.size};
    dispatchChunks(local_, cmd, push, light.chunkCount);
}

void LayerPass::recordWorth(VkCommandBuffer cmd, const LightBuffers& light, const Layer& layer,
                            const WorthWork& work, const vk::Buffer& chunkSums) const {
    const shader::LayerWorthPush push{.patches = light.patches.address(),
                                      .composite = work.local.composite.address(),
                                      .direct = layer.direct->address(),
                                      .result = layer.result.address(),
                                      .chunkSums = chunkSums.address(),
                                      .deviation = work.local.deviation,
                                      .least = work.local.least,
                                      .aim = work.aim,
                                      .chunkCount = light.chunkCount};
    dispatchChunks(worth_, cmd, push, light.chunkCount);
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
