#include "bake/layers/host_gather.h"

#include "bake/gather/host_resolve.h"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

namespace relume {
namespace {

constexpr uint32_t kToldSlots = 2; // LayerGather::Work::changes

} // namespace

HostGather::HostGather(LinkKit& kit, const ChunkSenders& senders)
    : kit_(kit), senders_(senders), radiancePass_(kit.input.device), resolvePass_(kit.input.device, false) {
    kit.reserveBack(uint64_t{kToldSlots} * kit.chunkCount() * sizeof(glm::vec4));
}

void HostGather::recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) {
    const vk::Buffer& ligIn = kit_.input.light.ligIn;
    const VkBufferCopy all{0, 0, ligIn.size()};
    vkCmdCopyBuffer(cmd, light.front()->handle(), ligIn.handle(), 1, &all);
}

void HostGather::recordSend(VkCommandBuffer cmd) {
    vk::barrier(cmd);
    radiancePass_.record(cmd, kit_.input.light, kit_.settings.transport);
}

void HostGather::startAtOnce(const vk::Buffer& light) {
    kit_.gatherPass.startOnCpu(kit_.input.light, kit_.settings.transport.reflectivity, senders_.full(),
                               light);
}

void HostGather::recordNewSums(VkCommandBuffer cmd) {
    vkCmdFillBuffer(cmd, kit_.buffers.linkSums.handle(), 0, VK_WHOLE_SIZE, 0);
}

void HostGather::recordGather(VkCommandBuffer cmd, const Work& work) {
    LinkGatherPass::Work links = work.links;
    links.direct = light_.direct;
    links.sky = light_.sky;
    kit_.gatherPass.record(cmd, kit_.input.light, kit_.buffers, links);
}

void HostGather::recordPassEnd(VkCommandBuffer cmd, const PassEnd& end) {
    LightBuffers& light = kit_.input.light;
    const uint32_t chunks = kit_.chunkCount();
    // Where the changes that are told go [bytes].
    const VkDeviceSize at = uint64_t{end.changes.value_or(0)} * chunks * sizeof(glm::vec4);
    if (end.bounce) {
        kit_.gatherPass.sendOnCpu(light, kit_.settings.transport.reflectivity, senders_.full(),
                                  end.changes ? kit_.back<glm::vec4>(at, chunks) : nullptr);
        return light.turn();
    }
    light.turn();
    vk::barrier(cmd);
    kit_.gatherPass.recordCompose(cmd, light, kit_.buffers, light_.direct, end.samples);
    if (end.changes) {
        vk::barrier(cmd);
        resolvePass_.recordChange(cmd, light, kit_.buffers);
        kit_.recordBack(cmd, kit_.buffers.chunkSums, chunks * sizeof(glm::vec4), at);
    }
    recordSend(cmd);
}

glm::dvec4 HostGather::change(uint32_t slot, uint32_t) const {
    const uint32_t chunks = kit_.chunkCount();
    return sumsOf(std::span<const glm::vec4>(
        kit_.back<glm::vec4>(uint64_t{slot} * chunks * sizeof(glm::vec4), chunks), chunks));
}

LevelSums HostGather::resolve(uint32_t, const Layer& layer, uint32_t linkSamplePasses, double sigma) {
    const LinkBuffers& buffers = kit_.buffers;
    const uint32_t samples = linkSamplePasses * kit_.linksOfSamplePass;
    const bool smooths = linkSamplePasses > 0 && buffers.rows;
    const float scale =
        samples > 0 ? static_cast<float>(shader::kReplicates) / static_cast<float>(samples) : 0.0f;
    const LayerResolveSums sums =
        resolveLayer(kit_.gatherPass.pool(), {.smoothing = kit_.smoothing(sigma, smooths),
                                              .direct = layer.direct->as<glm::vec4>(),
                                              .result = layer.result.as<glm::vec4>(),
                                              .scale = scale});
    LevelSums level{sumsOf(sums.indirect), sumsOf(sums.result), {}};
    const std::span patches(kit_.input.light.patches.as<shader::Patch>(),
                            size_t{kit_.chunkCount()} * shader::kChunk);
    if (linkSamplePasses > 0)
        level.sketch = sketchOf(kit_.gatherPass.pool(), patches, buffers.linkSums.as<glm::vec4>());
    level.sketch.number = newSketchNumber();
    if (smooths)
        std::transform(sums.indirect.begin(), sums.indirect.end(), std::back_inserter(level.sketch.bias),
                       [](const shader::ResolveSums& chunk) { return chunk.bias; });
    return level;
}

} // namespace relume
