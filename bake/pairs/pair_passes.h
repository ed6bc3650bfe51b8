#pragma once

#include <memory>

#include "assets/base/worker_pool.h"
#include "bake/solver/transport.h"
#include "bake/surface/light_buffers.h"
#include "bake/trace/tracer.h"
#include "bake/vk/program.h"

namespace relume {

/// The kinds of senders that pairs are made with.
enum class SenderKind : uint32_t {
    Patches, // the patches themselves; each pair is traced once and serves both ends
    List,    // a sender list
    Drawn,   // a list, a patch of each sender drawn by each chunk of receivers
};

/// The buffers of one batch of super-blocks.
struct PairBuffers {
    vk::Buffer supers;     // SuperBlock, the batch's table
    vk::Buffer transposed; // bits seen from the other side; patches as senders only
    vk::Buffer partial;    // vec4[2 * kSuperPatches] per super-block
    uint32_t capacity = 0; // super-blocks per batch

    PairBuffers() = default;
    /// Makes buffers for superCount super-blocks in all, with as many per batch as pay on the device.
    PairBuffers(const vk::Device& device, uint64_t superCount, SenderKind kind);
    /// Returns their bytes, and those of a BitsRing beside them; bothEnds as superBytes() has it.
    static uint64_t bytes(uint64_t superCount, SenderKind kind, bool bothEnds, bool software);
};

/// Holds bits until they are gathered: super-blocks take turns.
struct BitsRing {
    vk::Buffer bits;
    uint64_t slotBytes = 0;

    BitsRing() = default;
    BitsRing(const vk::Device& device, uint32_t slots, uint64_t slotBytes);
    VkDeviceAddress address(uint64_t slot) const { return bits.address() + slot * slotBytes; }
    uint32_t* host(uint64_t slot) const; // nullptr where the host cannot see it
};

/// Returns the bytes of a super-block's bits; bothEnds includes those traced from the other end.
constexpr uint64_t superBytes(bool bothEnds) {
    return uint64_t{shader::kSuperWords} * sizeof(uint32_t) * (bothEnds ? 2 : 1);
}

/// The senders of a list, and what they send, as the gather reads them.
struct SenderBuffers {
    vk::Buffer senders,
        members; // shader::Sender, uint32_t; for tracers senders are one patch each unless drawn
    vk::Buffer patches, edges, bounds;
    vk::Buffer radiance; // vec4 per sender
    vk::Buffer sends;    // uint32_t per chunk
    uint32_t chunkCount = 0;
};

/// The second half of RTL: gathers some super-blocks and adds the sums to ligOut in the table's order. It
/// reads bits, patches and radiance. It sets the barriers between its dispatches, the caller those around it.
/// On a software device all but the RTRad preset is gathered by host_pairs.h.
class GatherPass {
public:
    GatherPass(const vk::Device& device, SenderKind kind, const TransportSettings& settings);
    struct Desc {
        const LightBuffers& light;
        const PairBuffers& pairs;
        const SenderBuffers* senders = nullptr; // where there is a list
        std::span<const SuperBlock> supers;     // the table, as pairs.supers begins with
        std::span<uint32_t* const> bits;        // tracer.h, OcclusionWork
        uint32_t window = 1;                    // RTRad: senders within it are skipped [texels]
        uint32_t size = 0;                      // lightmap edge [texels]
        const TransportSettings& transport;
    };
    /// Tells whether record gathers at once, on the host; what it reads must be there by then.
    bool onCpu() const { return pool_ != nullptr; }
    void record(VkCommandBuffer cmd, const Desc& desc) const;

private:
    shader::GatherPush push(const Desc& desc) const;
    void gatherOnCpu(const Desc& desc) const;

    SenderKind kind_;
    WorkerPool* pool_; // the device's; nullptr: shaders gather
    vk::ComputeProgram transpose_, gather_, reduce_;
};

/// Ends a pass: the RTRad preset adds emission and restores lights.
class FinishPass {
public:
    explicit FinishPass(const vk::Device& device) : program_(device, "finish") {}
    void record(VkCommandBuffer cmd, const LightBuffers& light, bool rtrad) const;

private:
    vk::ComputeProgram program_;
};

} // namespace relume
