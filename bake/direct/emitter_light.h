#pragma once

#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/direct/penumbra.h"
#include "bake/lights/emitters.h"
#include "bake/surface/light_buffers.h"
#include "bake/trace/tracer.h"
#include "bake/vk/program.h"

namespace relume {

/// Direct light of what shines by itself (bake/lights/emitters.h), by rays to points on it. Emitters come in
/// groups, each sampled by itself: for each group record samples, trace segments(), then gather.
class EmitterLight {
public:
    /// links: of a round; as many points on emitters are about what one takes, but those of a pick for each
    /// replicate at least.
    EmitterLight(const vk::Device& device, const PatchSet& patches, uint32_t links);

    /// Groups in place of those before. No batch may be under way.
    void setGroups(const std::vector<EmitterSet>& groups);
    /// Of the group; 0: nothing in it shines, and no batch of it is to be made.
    uint32_t rays(uint32_t group) const { return groups_[group].targets(); }
    uint32_t batchChunks() const { return batchChunks_; } // at most in one batch
    struct Work {
        uint32_t group = 0;
        uint32_t round = 0;
        ChunkRange range; // count: at most batchChunks()
        // Found by the first round, heeded by later ones; nullptr: all patches take part in every round.
        const Penumbra* penumbra = nullptr;
    };
    /// Barriers are the caller's, here and below.
    void recordSamples(VkCommandBuffer cmd, const LightBuffers& light, const Work& work) const;
    /// rays: as SegmentWork.
    SegmentWork segments(const Work& work, const vk::Buffer& rays) const;
    /// Adds to sums, vec4[kReplicates][patches], and updates direct, vec4 per patch: their mean after round +
    /// 1 rounds.
    void recordGather(VkCommandBuffer cmd, const LightBuffers& light, const Work& work,
                      const vk::Buffer& sums, const vk::Buffer& direct) const;

    /// Of its buffers, for a scene with emitters.
    static uint64_t bytes(uint32_t chunkCount, bool software);

private:
    struct Group {
        vk::Buffer polygons, nodes; // EmitterPolygon, EmitterNode
        uint32_t picks = 0;         // of emitters, per patch and round; all of them where there are few
        uint32_t points = 0;        // on each picked emitter
        bool all = true;            // pick i is emitter i
        uint32_t targets() const { return picks * points; }
    };

    const vk::Device& device_;
    uint32_t links_, batchChunks_;
    std::vector<Group> groups_;
    uint32_t picksRoom_ = 0, targetsRoom_ = 0; // per patch, that there is memory for
    vk::Buffer targets_, picks_, bits_;        // of one batch
    vk::ComputeProgram samples_, gather_;
};

} // namespace relume
