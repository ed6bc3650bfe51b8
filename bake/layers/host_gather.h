#pragma once

#include "bake/gather/radiance_pass.h"
#include "bake/gather/chunk_senders.h"
#include "bake/layers/layer_gather.h"

namespace relume {

/// Gathers on the CPU of a software device, whose memory is the CPU's own. There is one lane.
class HostGather final : public LayerGather {
public:
    HostGather(LinkKit& kit, const ChunkSenders& senders);

    bool onCpu() const override { return true; }
    uint32_t room(uint32_t) override { return 1; }
    void begin(std::span<const LaneLight> light) override { light_ = light.front(); }
    void setLive(uint32_t) override {} // a lane alone goes on until it ends
    void recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) override;
    void recordSend(VkCommandBuffer cmd) override;
    void startAtOnce(const vk::Buffer& light) override;
    void recordNewSums(VkCommandBuffer cmd) override;
    void recordGather(VkCommandBuffer cmd, const Work& work) override;
    void recordPassEnd(VkCommandBuffer cmd, const PassEnd& end) override;
    void recordChanges(VkCommandBuffer) override {} // recordPassEnd() has told them
    glm::dvec4 change(uint32_t slot, uint32_t lane) const override;
    LevelSums resolve(uint32_t lane, const Layer& layer, uint32_t linkSamplePasses, double sigma) override;

private:
    LinkKit& kit_;
    const ChunkSenders& senders_;
    RadiancePass radiancePass_;
    ResolvePass resolvePass_;
    LaneLight light_; // of the lane
};

} // namespace relume
