#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "bake/chunk_order.h"
#include "bake/chunk_sums.h"
#include "bake/light_buffers.h"
#include "bake/vk/program.h"

namespace relume {

/// Bounces of up to four layers side by side on a GPU: what patches send lies together, so that one link, and
/// one access of 32 bytes to what is behind it, serves all of them. What a layer becomes is the same
/// whichever bounce beside it. Barriers are the caller's.
class LayerBounces {
public:
    static constexpr uint32_t kMostLanes = 4;

    /// light: where the first lane's light is, sums: where its sums over links are; both stay where they are.
    LayerBounces(const vk::Device& device, const LightBuffers& light, const vk::Buffer& sums);

    /// How many layers there is memory for, 1 or kMostLanes; that of the others is taken when it is first
    /// asked for.
    uint32_t room();
    /// A layer for each of these, vec4 per patch: direct light. None may be under way.
    void begin(std::span<const vk::Buffer* const> direct);
    /// Which of them go on, a bit each; others keep their light and sums.
    void setLive(uint32_t lanes) { live_ = lanes; }
    /// Their light is that of these buffers, vec4 per patch each.
    void recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) const;
    /// They send the light that they have.
    void recordSend(VkCommandBuffer cmd, float reflectivity) const;

    struct Work {
        VkDeviceAddress links = 0; // uint[chunks of the range][samples][64]
        uint32_t samples = 0;      // per patch
        ChunkRange range;
        uint32_t sums = 0;               // shader::kNoSums, kNewSums, kMoreSums
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
    void makeSent(uint32_t lanes);

    const vk::Device& device_;
    const LightBuffers& light_;
    const vk::Buffer& sums_;
    vk::Buffer lanes_;               // BounceLane[kMostLanes]
    std::array<vk::Buffer, 2> sent_; // uvec2[patches][lanes], one is read while the other one is made
    vk::Buffer changes_, totals_;
    std::vector<Beside> beside_; // the first lane
    vk::ComputeProgram one_, four_;
    ChunkSumPass sum_;
    uint32_t lanesOf_ = 1; // of the program that runs
    uint32_t count_ = 1;   // layers
    uint32_t live_ = 1, from_ = 0, now_ = 0;
};

} // namespace relume
