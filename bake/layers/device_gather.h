#pragma once

#include "bake/layers/layer_bounces.h"
#include "bake/layers/layer_gather.h"
#include "bake/layers/layer_passes.h"

namespace relume {

/// Gathers on a GPU, up to eight lanes side by side.
class DeviceGather final : public LayerGather {
public:
    DeviceGather(LinkKit& kit, const LayerPass& pass);

    bool onCpu() const override { return false; }
    uint32_t room(uint32_t layers) override { return bounces_.room(layers); }
    void begin(std::span<const LaneLight> light) override { bounces_.begin(light); }
    void setLive(uint32_t lanes) override { bounces_.setLive(lanes); }
    void recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) override;
    void recordSend(VkCommandBuffer cmd) override;
    void startAtOnce(const vk::Buffer& light) override;
    void recordNewSums(VkCommandBuffer) override {} // kNewSums says so where they are made
    void recordGather(VkCommandBuffer cmd, const Work& work) override;
    void recordPassEnd(VkCommandBuffer cmd, const PassEnd& end) override;
    void recordChanges(VkCommandBuffer cmd) override;
    glm::dvec4 change(uint32_t slot, uint32_t lane) const override;
    LevelSums resolve(uint32_t lane, const Layer& layer, uint32_t linkSamplePasses, double sigma) override;

private:
    void recordChunkSums(VkCommandBuffer cmd, uint32_t width, VkDeviceSize at);

    LinkKit& kit_;
    const LayerPass& layerPass_;
    LayerBounces bounces_;
    ResolvePass resolvePass_;
    ChunkSumPass chunkSums_;
    vk::Buffer sketch_;
};

} // namespace relume
