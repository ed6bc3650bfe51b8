#pragma once

#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/base/chunk_sums.h"
#include "bake/base/shader_types.h"
#include "bake/surface/light_buffers.h"
#include "bake/vk/program.h"

namespace relume {

/// Bounces of up to eight layers side by side on a GPU: what patches send lies together, so that one link,
/// and one access to what is behind it, serves all of them. What a layer becomes is the same whichever
/// bounce beside it. Barriers are the caller's.
class LayerBounces {
public:
    static constexpr uint32_t kMostLanes = 8;
    static constexpr uint32_t kMostRounds = std::extent_v<decltype(shader::BouncePush::links)>;

    /// light: where the first lane's light is, sums: where its sums over links are; both stay where they are.
    LayerBounces(const vk::Device& device, const LightBuffers& light, const vk::Buffer& sums);

    /// How many of so many layers there is room for; memory for more than one is taken when it is asked for.
    uint32_t room(uint32_t layers);
    /// A layer for each of these, vec4 per patch: direct light. None may be under way.
    void begin(std::span<const vk::Buffer* const> direct);
    /// Which of them go on, a bit each; others keep their light and sums.
    void setLive(uint32_t lanes) { live_ = lanes; }
    /// Their light is that of these buffers, vec4 per patch each.
    void recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) const;
    /// They send the light that they have.
    void recordSend(VkCommandBuffer cmd, float reflectivity) const;

    struct Work {
        std::vector<VkDeviceAddress> links; // of a round each, kMostRounds at most: uint[chunks][samples][64]
        uint32_t samples = 0;               // per patch and round
        ChunkRange range;
        uint32_t sums = 0;               // shader::kNoSums, kNewSums, kMoreSums
        bool keeps = true;               // light is read again: what changes next is told, or it is the last
        bool ends = false;               // the pass: light is made, and what is sent next
        float scale = 0;                 // of it, from the sum of all sums to the mean
        float reflectivity = 1;          // of it
        std::optional<uint32_t> changes; // it is told how much it changed, here (0 or 1)
    };
    void record(VkCommandBuffer cmd, const Work& work) const;
    /// The light that was made is what bounces now.
    void endPass();
    /// What was told, in changes(): vec4[2][lanes()] as ChangePush has it.
    void recordChanges(VkCommandBuffer cmd) const;
    const vk::Buffer& changes() const { return totals_; }
    uint32_t lanes() const { return lanesOf_; }
    /// Of a lane other than the first one: vec4[kReplicates][patches].
    vk::Buffer& sums(uint32_t lane) { return beside_[lane - 1].sums; }

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
    std::vector<Beside> beside_;               // the first lane
    std::vector<vk::ComputeProgram> programs_; // for 1, 2, 4 and 8 layers; where there are as many
    ChunkSumPass sum_;
    uint32_t lanesOf_ = 1; // of the program that runs
    uint32_t room_ = 1;    // lanes that there is memory for
    uint32_t count_ = 1;   // layers
    uint32_t live_ = 1, from_ = 0, now_ = 0;
};

} // namespace relume
