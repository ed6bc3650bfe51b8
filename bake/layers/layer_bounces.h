#pragma once

#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/base/chunk_sums.h"
#include "bake/base/shader_types.h"
#include "bake/layers/layer_gather.h"
#include "bake/surface/light_buffers.h"
#include "bake/vk/program.h"

namespace relume {

/// Bounces up to eight layers side by side on a GPU. What patches send lies together, so that one link, and
/// one access to what is behind it, serves all of them. What a layer becomes is the same whichever layers
/// bounce beside it. The caller sets the barriers.
class LayerBounces {
public:
    static constexpr uint32_t kMostLanes = 8;
    /// Names in the ledger of memory: what a lane beside the first one takes, and what grows with the lanes.
    static constexpr const char *kBesideLight = "light of a layer beside", *kBesideSums = "link sums beside",
                                *kPacked = "packed radiance", *kChanges = "changes of chunks";
    static constexpr uint32_t kMostRounds = std::extent_v<decltype(shader::BouncePush::links)>;

    /// Takes the first lane's light and its sums over links from `light` and `sums`; both must stay where
    /// they are.
    LayerBounces(const vk::Device& device, const LightBuffers& light, const vk::Buffer& sums);

    /// Returns for how many of so many layers there is room; memory for more than one is taken when it is
    /// asked for.
    uint32_t room(uint32_t layers);
    /// Begins with a layer for each of these. None may be under way.
    void begin(std::span<const LayerGather::LaneLight> light);
    /// Sets which of the layers go on, a bit each; the others keep their light and sums.
    void setLive(uint32_t lanes) { live_ = lanes; }
    /// Makes their light that of these buffers, vec4 per patch each.
    void recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) const;
    /// Makes them send the light that they have.
    void recordSend(VkCommandBuffer cmd, float reflectivity) const;

    struct Work {
        std::vector<VkDeviceAddress> links; // per sample pass, kMostRounds at most: uint[chunks][samples][64]
        uint32_t samples = 0;               // per patch and sample pass
        ChunkRange range;
        uint32_t sums = 0;               // shader::kNoSums, kNewSums, kMoreSums
        bool keeps = true;               // light is stored: its next change is told, or it is the last
        bool ends = false;               // it ends the bounce: light is made, and what is sent next
        float scale = 0;                 // for that, from the sum of all sums to the mean
        float reflectivity = 1;          // for that
        std::optional<uint32_t> changes; // where it is told how much light changed (0 or 1)
    };
    void record(VkCommandBuffer cmd, const Work& work) const;
    /// Ends a bounce: the light that was made is what bounces now.
    void endPass();
    /// Sums up what was told, to changes(): vec4[2][lanes()] as in ChangePush.
    void recordChanges(VkCommandBuffer cmd) const;
    const vk::Buffer& changes() const { return totals_; }
    uint32_t lanes() const { return lanesOf_; }
    /// Returns the sums of a lane other than the first one: vec4[kReplicates][patches].
    const vk::Buffer& sums(uint32_t lane) const { return beside_[lane - 1].sums; }

private:
    struct Beside {
        vk::Buffer lightA, lightB, sums;
    };
    shader::BouncePush push(float reflectivity) const;
    void dispatch(VkCommandBuffer cmd, const shader::BouncePush& push, uint32_t chunks) const;
    bool grow(uint32_t lanes);
    void makeSent(uint32_t lanes);

    const vk::Device& device_;
    const LightBuffers& light_;
    const vk::Buffer& sums_;
    vk::Buffer lanes_;               // BounceLane[kMostLanes]
    std::array<vk::Buffer, 2> sent_; // uvec2[patches][lanesOf_], one is read while the other one is made
    vk::Buffer changes_, totals_;
    std::vector<Beside> beside_; // lanes beside the first one
    // For 1, 2, 4 and 8 layers, as far as the device runs them; skyPrograms_ where links bring any the sky's
    // light.
    std::vector<vk::ComputeProgram> programs_, skyPrograms_;
    ChunkSumPass sum_;
    uint32_t lanesOf_ = 1; // of the program that runs
    bool seesSky_ = false; // likewise
    uint32_t room_ = 1;    // lanes that there is memory for
    uint32_t count_ = 1;   // layers
    uint32_t live_ = 1, from_ = 0, now_ = 0;
};

} // namespace relume
