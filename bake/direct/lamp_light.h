#pragma once

#include <span>

#include "bake/base/chunk_order.h"
#include "bake/direct/penumbra.h"
#include "bake/direct/point_trace.h"
#include "bake/lights/lamps.h"
#include "bake/surface/light_buffers.h"
#include "bake/trace/tracer.h"
#include "bake/vk/program.h"

namespace relume {

/// One of the analytic lights that are sampled.
struct LampChoice {
    uint32_t lamp = 0;     // of Scene::lights; as many as these: the sky
    glm::vec3 color{1.0f}; // in place of its own
    uint32_t set = 0;      // lights of one set, one behind the other, share groups
};

/// Direct light of analytic lights (bake/lights/lamps.h), by rays to points on them. They take turns in
/// groups that share a batch of rays: for each group record samples, trace segments(), then gather.
class LampLight {
public:
    struct Desc {
        uint32_t samples = 16; // as LampDesc has it
        bool sky = true;       // the sky is among them
        bool chosen = false;   // none until update() says which
        bool allOver = false;  // samples start all over their texels (LightBuffers::covers)
    };
    LampLight(const vk::Device& device, const Scene& scene, const PatchSet& patches, const Desc& desc);

    /// Takes the analytic lights as they are now, with Desc::chosen; sky picture and patches are the same as
    /// before. No batch may be under way.
    void update(const Scene& scene, std::span<const LampChoice> choices);
    /// Returns the groups of a LampChoice::set.
    std::vector<uint32_t> groupsOf(uint32_t set) const;
    /// Follows triangles that stand elsewhere now. Returns whether rays to the sky and to suns end elsewhere,
    /// too.
    bool updateReach(const WorldMesh& mesh);

    bool empty() const { return groups_.empty(); }
    uint32_t groups() const { return static_cast<uint32_t>(groups_.size()); }
    uint32_t rays() const { return rays_; } // per patch and sample pass, of all groups
    uint32_t rays(uint32_t group) const { return groups_[group].targets; }
    float reach() const { return set_.reach; } // how far away rays to the sky and to suns end [m]
    bool hasSky() const { return !set_.empty() && set_.lamps.back().type == shader::kLampSky; }
    uint32_t batchChunks() const { return batchChunks_; } // at most in one batch of one sample pass
    struct Work {
        uint32_t group = 0;
        uint32_t samplePass = 0, together = 1; // as of EmitterSamplesPush
        ChunkRange range;                      // count: at most batchChunks() / together
        const vk::Buffer* chunks = nullptr;    // as of SegmentWork, whose numbers are those of `range`
        // The first sample pass finds penumbrae, later ones heed them; nullptr: all patches take part in
        // every pass.
        const Penumbra* penumbra = nullptr;
        // Or each chunk notes in the first sample pass which lights all of its rays agree on, and asks those
        // in few later ones (lib/light/light_notes.glsl): uvec2 per chunk, all 0 before; not on the CPU.
        const vk::Buffer* notes = nullptr;
        const vk::Buffer* soFar = nullptr; // with notes: direct light, vec4 per patch
    };
    /// Records the samples. The caller writes the barriers, here and below.
    void recordSamples(VkCommandBuffer cmd, const LightBuffers& light, const Work& work) const;
    /// Tells whether the CPU can do without the device, where it traces: this holds for all analytic lights
    /// but the sky.
    bool onCpu(uint32_t group) const;
    /// Samples, traces and gathers on the CPU, at once; the light goes where that of recordGather goes.
    PointTimes traceOnCpu(const LightBuffers& light, const Work& work, const PointsOnCpu& on) const;
    /// Returns the segments to the points; `rays` is as in SegmentWork.
    SegmentWork segments(const LightBuffers& light, const Work& work, const vk::Buffer& rays) const;
    /// Adds to sums, vec4[kReplicates][patches], and updates direct, vec4 per patch: their mean after
    /// samplePass + 1 sample passes.
    void recordGather(VkCommandBuffer cmd, const LightBuffers& light, const Work& work,
                      const vk::Buffer& sums, const vk::Buffer& direct) const;

    /// The lights that share groups: those with an extent take Desc::samples rays each, the others one, or
    /// with Desc::allOver one for each replicate.
    struct Count {
        uint32_t extended = 0, points = 0;
    };
    /// Returns the most rays per patch of a group; many lights take no more than kMostGroupRays.
    static uint32_t groupRays(const Count& lights, uint32_t samples, bool allOver);
    static constexpr uint32_t kMostGroupRays =
        64; // two words of bits; a light with more is a group by itself
    /// Returns the bytes of a batch, where the largest group has so many rays; 0 for none.
    static uint64_t bytes(uint32_t chunkCount, bool software, uint32_t rays);
    /// Returns the bytes of its tables of lights and of the sky's picture.
    static uint64_t tableBytes(const Count& lights, uint64_t skyPixels, uint64_t skyRows);

private:
    LampDesc lampDesc() const;
    struct Programs {
        vk::ComputeProgram samples, gather;
    };
    struct Group {
        uint32_t first = 0, count = 0; // lights
        uint32_t targets = 0;          // per patch
        uint32_t set = 0;
    };
    void group(const std::vector<uint32_t>& sets); // of each light
    const Programs& programsOf(uint32_t group) const;
    shader::LampPush push(const LightBuffers& light, const Work& work) const;

    const vk::Device& device_;
    Desc desc_;
    uint32_t chunkCount_;
    LampSet set_;
    std::vector<Group> groups_;
    uint32_t rays_ = 0, batchChunks_ = 0;
    uint32_t room_ = 0;               // targets per patch that there is memory for
    vk::Buffer lamps_, sky_;          // Lamp[]; as of LampPush
    vk::Buffer targets_, bits_;       // of one batch
    Programs programs_, skyPrograms_; // for all types of lights; for groups of the sky alone
};

} // namespace relume
