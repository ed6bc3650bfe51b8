#include "app/live/layer_probes.h"

#include "bake/base/shader_types.h"

#include <cstring>
#include <utility>

namespace relume {

void LayerProbes::ask(ProbeRequest request) {
    request_ = std::move(request);
    forget();
}

void LayerProbes::forget() {
    patches_.clear();
    told_.clear();
}

std::optional<LayerProbe> LayerProbes::next(const LayerSolver& solver, const PatchAt& patchAt) {
    if (request_.texels.empty()) return std::nullopt;
    if (patches_.empty())
        for (const uint32_t texel : request_.texels)
            patches_.push_back(patchAt(texel));
    for (const std::unique_ptr<Layer>& layer : solver.layers()) {
        const Layer* shown = layer->shown();
        if (shown == nullptr) continue;
        const Told now{shown->cacheKey, shown->level};
        const auto found = told_.find(layer->source.key);
        if (found != told_.end() && found->second == now) continue;
        told_.insert_or_assign(layer->source.key, now);
        return LayerProbe{.request = request_.number, .key = layer->source.key, .light = read(shown->result)};
    }
    return std::nullopt;
}

std::vector<glm::vec3> LayerProbes::read(const vk::Buffer& result) {
    constexpr VkDeviceSize kBytes = sizeof(glm::vec4);
    if (!values_ || values_.size() < patches_.size() * kBytes)
        values_ = vk::Buffer(
            device_,
            {.size = patches_.size() * kBytes, .memory = vk::Memory::Host, .name = "layers at texels"});
    std::vector<VkBufferCopy> regions;
    for (size_t i = 0; i < patches_.size(); ++i)
        if (patches_[i] != shader::kNoPatch) regions.push_back({patches_[i] * kBytes, i * kBytes, kBytes});
    std::vector<glm::vec3> light(patches_.size(), glm::vec3(0.0f));
    if (regions.empty()) return light;
    VkCommandBuffer cmd = commands_.begin();
    vk::barrier(cmd);
    vkCmdCopyBuffer(cmd, result.handle(), values_.handle(), static_cast<uint32_t>(regions.size()),
                    regions.data());
    vk::hostBarrier(cmd);
    commands_.run();
    const auto* values = static_cast<const glm::vec4*>(values_.mapped());
    for (size_t i = 0; i < patches_.size(); ++i)
        if (patches_[i] != shader::kNoPatch) light[i] = glm::vec3(values[i]);
    return light;
}

} // namespace relume
