#include "bake/links/footprint.h"

#include "bake/base/chunk_dispatch.h"
#include "bake/vk/commands.h"

#include <bit>
#include <limits>

namespace relume {
namespace {

using shader::kChunk;

// Returns the way up from each patch and node, with all that the next step needs in one load. A parent that
// is not there is larger than any area.
std::vector<glm::uvec2> stepsOf(const PatchPyramid& pyramid) {
    const auto patchCount = static_cast<uint32_t>(pyramid.parents.size());
    const auto step = [&](uint32_t parent) {
        const float size = parent == shader::kNoPatch ? std::numeric_limits<float>::infinity()
                                                      : pyramid.nodes[parent - patchCount].size;
        return glm::uvec2(parent, std::bit_cast<uint32_t>(size));
    };
    std::vector<glm::uvec2> steps;
    steps.reserve(pyramid.parents.size() + pyramid.nodes.size());
    for (const uint32_t parent : pyramid.parents)
        steps.push_back(step(parent));
    for (const shader::PyramidNode& node : pyramid.nodes)
        steps.push_back(step(node.parent));
    return steps;
}

} // namespace

Footprints::Footprints(const vk::Device& device, const PatchSet& patches)
    : patchCount_(static_cast<uint32_t>(patches.scene.patches.size())), pyramid_(device, "pyramid"),
      footprint_(device, "footprint") {
    PatchPyramid pyramid = buildPatchPyramid(patches);
    nodeCount_ = static_cast<uint32_t>(pyramid.nodes.size());
    levelEnds_ = std::move(pyramid.levelEnds);
    nodes_ = vk::makeBuffer(device, pyramid.nodes, "patch pyramid");
    steps_ = vk::makeBuffer(device, stepsOf(pyramid), "steps of the pyramid");
}

uint64_t Footprints::bytes(uint64_t patches, uint64_t nodes) {
    return nodes * sizeof(shader::PyramidNode) + (patches + nodes) * sizeof(glm::uvec2);
}

void Footprints::recordLevels(VkCommandBuffer cmd, const vk::Buffer& radiance) const {
    uint32_t first = 0;
    for (const uint32_t end : levelEnds_) {
        if (first > 0) vk::barrier(cmd);
        const shader::PyramidPush push{.nodes = nodes_.address(),
                                       .radiance = radiance.address(),
                                       .firstNode = first,
                                       .nodeCount = end - first,
                                       .patchCount = patchCount_};
        dispatchChunks(pyramid_, cmd, push, (end - first + kChunk - 1) / kChunk);
        first = end;
    }
}

void Footprints::recordLinks(VkCommandBuffer cmd, VkDeviceAddress patches, const Work& work) const {
    const shader::FootprintPush push{.patches = patches,
                                     .receivers = work.receivers,
                                     .steps = steps_.address(),
                                     .links = work.links,
                                     .firstChunk = work.firstChunk,
                                     .chunkCount = work.chunkCount,
                                     .sampleCount = work.sampleCount,
                                     .samples = work.samples};
    dispatchChunks(footprint_, cmd, push, work.chunkCount);
}

} // namespace relume
