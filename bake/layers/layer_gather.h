#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bake/gather/link_kit.h"
#include "bake/layers/layer.h"

namespace relume {

/// Sums over all patches: of bounces as they were smoothed, and of the result as LayerPass tells it; and how
/// bounces are off before they are smoothed.
struct LevelSums {
    shader::ResolveSums indirect{};
    glm::dvec4 result{0.0};
    ErrorSketch sketch;
};

/// Gathers light over links for the layers that bounce together, each in a lane, and makes their results. The
/// device does so for several lanes side by side, the CPU of a software device for one without a submit. A
/// level comes out the same whichever lanes bounce beside it.
class LayerGather {
public:
    virtual ~LayerGather() = default;

    /// Tells whether the CPU gathers, so that what it reads must be there.
    virtual bool onCpu() const = 0;
    /// Returns for how many of so many layers there is room; takes the memory for more than one.
    virtual uint32_t room(uint32_t layers) = 0;
    /// Holds what comes to a lane at each bounce from outside: direct light, vec4 per patch, and the radiance
    /// of the sky that links bring.
    struct LaneLight {
        const vk::Buffer* direct = nullptr;
        glm::vec3 sky{0.0f};
    };
    /// Begins with a lane for each of these.
    virtual void begin(std::span<const LaneLight> light) = 0;
    /// Sets which of the lanes go on, a bit each.
    virtual void setLive(uint32_t lanes) = 0;

    /// Makes the lanes' light that of these buffers. The caller writes no barriers, here and below.
    virtual void recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) = 0;
    /// Makes what patches send of the lanes' light.
    virtual void recordSend(VkCommandBuffer cmd) = 0;
    /// Does both at once for the one lane of the CPU.
    virtual void startAtOnce(const vk::Buffer& light) = 0;
    /// Begins the sums over links anew.
    virtual void recordNewSums(VkCommandBuffer cmd) = 0;

    /// A portion of a pass.
    struct Work {
        LinkGatherPass::Work links;             // without direct light; output: a bounce, else sums are made
        std::vector<VkDeviceAddress> following; // links of later sample passes, gathered along
        bool keeps = true;                      // light is stored: its next change is told, or it is the last
        bool ends = false;                      // it ends the pass with new light, which is sent next
        float scale = 0;                        // from the sum of all sums to the mean
        std::optional<uint32_t> changes;        // where it is told how much light changed (0 or 1)
    };
    virtual void recordGather(VkCommandBuffer cmd, const Work& work) = 0;
    /// Makes the light that was gathered what is sent next: that of a bounce, or the mean of the sums over
    /// `samples` links per patch. `changes` is as in Work.
    struct PassEnd {
        bool bounce = false;
        uint32_t samples = 0;
        std::optional<uint32_t> changes;
    };
    virtual void recordPassEnd(VkCommandBuffer cmd, const PassEnd& end) = 0;
    /// Reads back what was told of changes; change() returns it after the submit, as ChangePush has it.
    virtual void recordChanges(VkCommandBuffer cmd) = 0;
    virtual glm::dvec4 change(uint32_t slot, uint32_t lane) const = 0;

    /// Makes the layer's result of the lane's sums over so many sample passes of links, smoothed by sigma
    /// [texels]; with none, of direct light alone. Waits for it.
    virtual LevelSums resolve(uint32_t lane, const Layer& layer, uint32_t linkSamplePasses, double sigma) = 0;
};

} // namespace relume
