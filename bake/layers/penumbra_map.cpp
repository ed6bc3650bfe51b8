#include "bake/layers/penumbra_map.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace relume {

PenumbraMap::PenumbraMap(LinkKit& kit) : kit_(kit), parts_(makeTileParts(kit.input.patches)) {
    const vk::Device& device = kit.input.device;
    penumbra_ = {vk::makeBuffer(device, parts_.ofPatch, "parts of tiles"),
                 vk::Buffer(device, {.size = parts_.count * sizeof(glm::uvec2), .name = "penumbra"})};
    if (penumbra_.lights.mapped() == nullptr)
        next_ = vk::Buffer(
            device, {.size = penumbra_.lights.size(), .memory = vk::Memory::Host, .name = "penumbra to be"});
    kit.reserveBack(kit.buffers.rays.size() + penumbra_.lights.size());
}

void PenumbraMap::set(const std::vector<uint8_t>& within) {
    const bool direct = penumbra_.lights.mapped() != nullptr;
    auto* lights = (direct ? penumbra_.lights : next_).as<glm::uvec2>();
    std::transform(within.begin(), within.end(), lights, [](uint8_t in) { return glm::uvec2(in); });
    due_ = !direct;
}

void PenumbraMap::recordUpload(VkCommandBuffer cmd) {
    if (!std::exchange(due_, false)) return;
    const VkBufferCopy all{0, 0, penumbra_.lights.size()};
    vkCmdCopyBuffer(cmd, next_.handle(), penumbra_.lights.handle(), 1, &all);
}

void PenumbraMap::recordClear(VkCommandBuffer cmd) const {
    vkCmdFillBuffer(cmd, penumbra_.lights.handle(), 0, VK_WHOLE_SIZE, 0);
}

void PenumbraMap::clearOnCpu() const {
    std::memset(penumbra_.lights.as<uint8_t>(), 0, penumbra_.lights.size());
}

// Reads it back behind the counters of rays.
void PenumbraMap::recordBack(VkCommandBuffer cmd) const {
    kit_.recordBack(cmd, penumbra_.lights, penumbra_.lights.size(), kit_.buffers.rays.size());
}

bool PenumbraMap::within(size_t part) const {
    const glm::uvec2 lights = kit_.back<glm::uvec2>(kit_.buffers.rays.size(), part + 1)[part];
    return (lights.x & lights.y) != 0;
}

} // namespace relume
