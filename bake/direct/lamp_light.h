#pragma once

#include <span>

#include "bake/base/chunk_order.h"
#include "bake/direct/host_lamps.h"
#include "bake/direct/penumbra.h"
#include "bake/lights/lamps.h"
#include "bake/surface/light_buffers.h"
#include "bake/trace/tracer.h"
#include "bake/vk/program.h"

namespace relume {

/// A lamp of those that are sampled.
struct LampChoice {
    uint32_t lamp = 0;     // of Scene::lights; as many as these: the sky
    glm::vec3 color{1.0f}; // in place of its own
    uint32_t set = 0;      // lamps of one set, one behind the other, share groups
};

/// Direct light of lamps (bake/lights/lamps.h), by rays to points on them. Lamps take turns in groups that
/// share a batch of rays: for each group record samples, trace segments(), then gather.
class LampLight {
public:
    struct Desc {
        uint32_t samples = 16; // as LampDesc has it
        bool chosen = false;   // none until update() says which
    };
    LampLight(const vk::Device& device, const Scene& scene, const PatchSet& patches, const Desc& desc);

    /// With Desc::chosen: lamps as they are now; sky picture and patches are the same as before. No batch may
    /// be under way.
    void update(const Scene& scene, std::span<const LampChoice> choices);
    /// Of a LampChoice::set.
    std::vector<uint32_t> groupsOf(uint32_t set) const;
    /// Triangles stand elsewhere now. Whether rays to the sky and to suns end elsewhere, too.
    bool updateReach(const WorldMesh& mesh);

    bool empty() const { return groups_.empty(); }
    uint32_t groups() const { return static_cast<uint32_t>(groups_.size()); }
    uint32_t rays() const { return rays_; } // per patch and round, of all groups
    uint32_t rays(uint32_t group) const { return groups_[group].targets; }
    float reach() const { return set_.reach; } // how far away rays to the sky and to suns end [m]
    bool hasSky() const { return !set_.empty() && set_.lamps.back().type == shader::kLampSky; }
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
    /// Whether the CPU can do both, where it traces: of all lamps but the sky.
    bool onCpu(uint32_t group) const;
    void sampleOnCpu(WorkerPool& pool, const LightBuffers& light, const Work& work) const;
    /// As recordGather, at once. newSums: there is nothing in them yet.
    void gatherOnCpu(WorkerPool& pool, const LightBuffers& light, const Work& work, bool newSums,
                     const vk::Buffer& sums, const vk::Buffer& direct) const;
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
        uint32_t set = 0;
    };
    void group(const std::vector<uint32_t>& sets); // of each lamp
    shader::LampPush push(const LightBuffers& light, const Work& work) const;
    HostLamps host(const LightBuffers& light, const Work& work) const;

    const vk::Device& device_;
    Desc desc_;
    uint32_t chunkCount_;
    LampSet set_;
    std::vector<Group> groups_;
    uint32_t rays_ = 0, batchChunks_ = 0;
    uint32_t room_ = 0;                      // targets per patch that there is memory for
    vk::Buffer lamps_, skyPixels_, skyRows_; // Lamp[], vec4[], float[]
    vk::Buffer targets_, bits_;              // of one batch
    vk::ComputeProgram samples_, gather_;
};

} // namespace relume
