#pragma once

#include "bake/light_buffers.h"
#include "bake/trace/tracer.h"
#include "bake/vk/program.h"

namespace relume {

/// How light is transported, for all passes of a bake.
struct TransportSettings {
    float reflectivity = 1.0f;   // scales the albedo; RTRad: 0.9
    float distanceFactor = 1.0f; // RTRad preset only
    bool rtrad = false;          // RTRad's form factor, clamps and light skip
    bool allSend = false;        // dark chunks count as senders too: a pass of full length
    bool reflectedOnly = false;  // what patches send is without their emission, which is sampled by itself
};

/// Buffers of one batch of super-blocks. Slot of a unit: unit % bitsUnits (see OcclusionWork).
struct PairBuffers {
    vk::Buffer supers;     // SuperBlock, the pass's list
    vk::Buffer bits;       // kBlockWords words per unit
    vk::Buffer reversed;   // the same, traced from the other end; empty where both ends agree (always but in
                           // the preset)
    vk::Buffer transposed; // seen from the other side
    vk::Buffer partial;    // vec4[2 * kSuperPatches] per super-block of the batch
    uint32_t bitsUnits = 0;

    PairBuffers() = default;
    /// For a list of superCount super-blocks and as many per batch as pay on the device.
    PairBuffers(const vk::Device& device, uint64_t superCount, bool rtrad);
    uint32_t capacity() const { return bitsUnits / shader::kSuperBlocks; } // super-blocks per batch
    static uint64_t bytes(uint64_t superCount, bool software);             // at most
};

/// Consecutive super-blocks of the list.
struct SuperRange {
    uint32_t first = 0, count = 0;
};

/// Forms what each patch sends and notes which chunks send at all. Reads ligIn.
class RadiancePass {
public:
    explicit RadiancePass(const vk::Device& device) : program_(device, "radiance") {}
    void record(VkCommandBuffer cmd, const LightBuffers& light, const TransportSettings& settings) const;

private:
    vk::ComputeProgram program_;
};

/// RTL, second half: transposes the bits of some super-blocks, gathers both sides and adds the sums
/// to ligOut in the list's order. Reads bits, patches and radiance. Barriers between its three
/// dispatches are its own, those around it the caller's.
class GatherPass {
public:
    GatherPass(const vk::Device& device, bool rtrad);
    void record(VkCommandBuffer cmd, const LightBuffers& light, const PairBuffers& pairs,
                const SuperRange& range, const TransportSettings& settings) const;

private:
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
