#include "bake/layers/device_gather.h"

#include "assets/base/error.h"

#include <span>
#include <utility>

namespace relume {
namespace {

// These are floats per chunk.
constexpr uint32_t kResolveValues = sizeof(shader::ResolveSums) / sizeof(float);
constexpr uint32_t kResultValues = sizeof(glm::vec4) / sizeof(float);

} // namespace

DeviceGather::DeviceGather(LinkKit& kit, const LayerPass& pass)
    : kit_(kit), layerPass_(pass), bounces_(kit.input.device, kit.input.light, kit.buffers.linkSums),
      resolvePass_(kit.input.device, true), chunkSums_(kit.input.device),
      sketch_(kit.input.device, {.size = kSketchEntries * sizeof(glm::vec3), .name = "sketch of an error"}) {
    kit.reserveBack(kLevelSumsAt + uint64_t{kit.chunkCount()} * sizeof(shader::ResolveSums));
}

void DeviceGather::recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) {
    bounces_.recordStart(cmd, light);
}

void DeviceGather::recordSend(VkCommandBuffer cmd) {
    vk::barrier(cmd);
    bounces_.recordSend(cmd, kit_.settings.transport.reflectivity);
}

void DeviceGather::startAtOnce(const vk::Buffer&) {
    ASSERT(false); // a GPU needs a submit
}

void DeviceGather::recordGather(VkCommandBuffer cmd, const Work& work) {
    std::vector<VkDeviceAddress> links = {work.links.address()};
    links.insert(links.end(), work.following.begin(), work.following.end());
    const uint32_t sums = work.links.newSums ? shader::kNewSums : shader::kMoreSums;
    bounces_.record(cmd, {.links = std::move(links),
                          .samples = work.links.samples,
                          .range = work.links.range,
                          .sums = work.links.output ? shader::kNoSums : sums,
                          .keeps = work.keeps,
                          .ends = work.ends,
                          .scale = work.scale,
                          .reflectivity = kit_.settings.transport.reflectivity,
                          .changes = work.changes});
}

// The kernel has made the light and what is sent; they only change places.
void DeviceGather::recordPassEnd(VkCommandBuffer cmd, const PassEnd&) {
    vk::barrier(cmd);
    bounces_.endPass();
}

void DeviceGather::recordChanges(VkCommandBuffer cmd) {
    bounces_.recordChanges(cmd);
    kit_.recordBack(cmd, bounces_.changes(), bounces_.changes().size());
}

glm::dvec4 DeviceGather::change(uint32_t slot, uint32_t lane) const {
    return *kit_.back<glm::vec4>(uint64_t{slot * bounces_.lanes() + lane} * sizeof(glm::vec4));
}

// Reads back the sum over all chunks.
void DeviceGather::recordChunkSums(VkCommandBuffer cmd, uint32_t width, VkDeviceSize at) {
    vk::barrier(cmd);
    chunkSums_.record(cmd, {.values = kit_.buffers.chunkSums.address(),
                            .sums = kit_.buffers.sums.address(),
                            .chunkCount = kit_.chunkCount(),
                            .width = width});
    kit_.recordBack(cmd, kit_.buffers.sums, width * sizeof(float), at);
}

LevelSums DeviceGather::resolve(uint32_t lane, const Layer& layer, uint32_t linkSamplePasses, double sigma) {
    const LightBuffers& light = kit_.input.light;
    const LinkBuffers& buffers = kit_.buffers;
    const bool smooths = linkSamplePasses > 0 && buffers.rows;
    const size_t chunks = kit_.chunkCount();
    VkCommandBuffer cmd = kit_.commands.begin();
    if (linkSamplePasses > 0) {
        const vk::Buffer& own = lane > 0 ? bounces_.sums(lane) : buffers.linkSums;
        layerPass_.recordSketch(cmd, light, own, sketch_);
        resolvePass_.record(cmd, light, buffers,
                            {.samples = linkSamplePasses * kit_.linksOfSamplePass,
                             .sigma = static_cast<float>(sigma),
                             .sums = lane > 0 ? &bounces_.sums(lane) : nullptr});
        recordChunkSums(cmd, kResolveValues, 0);
        if (smooths)
            kit_.recordBack(cmd, buffers.chunkSums, chunks * sizeof(shader::ResolveSums), kLevelSumsAt);
        vk::barrier(cmd);
    }
    layerPass_.recordResult(cmd, light, layer, linkSamplePasses > 0 ? &buffers.result : nullptr,
                            buffers.chunkSums);
    recordChunkSums(cmd, kResultValues, sizeof(shader::ResolveSums));
    if (linkSamplePasses > 0) kit_.recordBack(cmd, sketch_, sketch_.size(), kSketchAt);
    kit_.run(cmd);
    LevelSums sums;
    if (linkSamplePasses > 0) {
        sums.indirect = sumsOf(std::span(kit_.back<shader::ResolveSums>(), 1));
        const auto* entries = kit_.back<glm::vec3>(kSketchAt, kSketchEntries);
        sums.sketch.entries.assign(entries, entries + kSketchEntries);
        sums.sketch.number = newSketchNumber();
    }
    if (smooths) {
        const auto* perChunk = kit_.back<shader::ResolveSums>(kLevelSumsAt, chunks);
        std::transform(perChunk, perChunk + chunks, std::back_inserter(sums.sketch.bias),
                       [](const shader::ResolveSums& chunk) { return chunk.bias; });
    }
    sums.result = *kit_.back<glm::vec4>(sizeof(shader::ResolveSums));
    return sums;
}

} // namespace relume
