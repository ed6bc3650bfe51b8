#pragma once

#include "bake/chunk_order.h"
#include "bake/lamps.h"
#include "bake/light_buffers.h"
#include "bake/trace/tracer.h"
#include "bake/vk/program.h"

namespace relume {

/// Direct light of lamps (bake/lamps.h), by rays to points on them. Lamps take turns in groups that share a
/// batch of rays: for each group record samples, trace segments(), then gather.
class LampLight {
public:
    /// samples: as buildLamps has it.
    LampLight(const vk::Device& device, const Scene& scene, const PatchSet& patches, uint32_t samples);

    bool empty() const { return groups_.empty(); }
    uint32_t groups() const { return static_cast<uint32_t>(groups_.size()); }
    uint32_t rays() const { return rays_; }               // per patch and round
    uint32_t batchChunks() const { return batchChunks_; } // at most in one batch
    struct Work {
        uint32_t group = 0;
        uint32_t round = 0;
        ChunkRange range; // count: at most batchChunks()
    };
    /// Barriers are the caller's, here and below.
    void recordSamples(VkCommandBuffer cmd, const LightBuffers& light, const Work& work) const;
    /// rays: as SegmentWork.
    SegmentWork segments(const Work& work, const vk::Buffer& rays) const;
    /// Adds to sums, vec4[kReplicates][patches], and updates direct, vec4 per patch: their mean after round +
    /// 1 rounds.
    void recordGather(VkCommandBuffer cmd, const LightBuffers& light, const Work& work,
                      const vk::Buffer& sums, const vk::Buffer& direct) const;

    /// Of its buffers, for a scene with lamps.
    static uint64_t bytes(uint32_t chunkCount, bool software);

private:
    struct Group {
        uint32_t first = 0, count = 0; // lamps
        uint32_t targets = 0;          // per patch
    };
    shader::LampPush push(const LightBuffers& light, const Work& work) const;

    LampSet set_;
    std::vector<Group> groups_;
    uint32_t rays_ = 0, batchChunks_ = 0;
    vk::Buffer lamps_, skyPixels_, skyRows_; // Lamp[], vec4[], float[]
    vk::Buffer targets_, bits_;              // of one batch
    vk::ComputeProgram samples_, gather_;
};

} // namespace relume
