#pragma once

#include <optional>
#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/direct/penumbra.h"
#include "bake/direct/point_trace.h"
#include "bake/lights/emitters.h"
#include "bake/surface/light_buffers.h"
#include "bake/trace/tracer.h"
#include "bake/vk/program.h"

namespace relume {

/// Direct light of mesh lights (bake/lights/emitters.h), by rays to points on them. Mesh lights come in
/// groups, each sampled by itself: for each group record samples, trace segments(), then gather.
class EmitterLight {
public:
    /// Takes the directions per sample pass: what is picked gets about as many points, but at least those of
    /// one pick for each replicate; each polygon of those that are all sampled gets as many or a quarter.
    struct Desc {
        uint32_t links = 0;
        bool allOver = false; // samples start all over their texels (LightBuffers::covers)
        // Each group is one light: where its polygons are picked, picks tell the share of it that is seen.
        bool lightByLight = false;
    };
    EmitterLight(const vk::Device& device, const PatchSet& patches, const Desc& desc);

    /// Sets the groups in place of those before. No batch may be under way.
    void setGroups(const std::vector<EmitterSet>& groups);
    /// Returns the rays per patch and sample pass of the group; 0 means that nothing in it shines, and no
    /// batch of it is to be made.
    uint32_t rays(uint32_t group) const { return groups_[group].targets(); }
    /// Returns the most chunks in one batch of one sample pass, for the groups as they are.
    uint32_t batchChunks() const { return batchChunks_; }
    struct Work {
        uint32_t group = 0;
        uint32_t samplePass = 0, together = 1; // as of EmitterSamplesPush
        ChunkRange range;                      // count: at most batchChunks() / together
        const vk::Buffer* chunks = nullptr;    // as of SegmentWork, whose numbers are those of `range`
        // The first sample pass finds penumbrae, later ones heed them; nullptr: all patches take part in
        // every pass.
        const Penumbra* penumbra = nullptr;
    };
    /// Records the samples. The caller writes the barriers, here and below.
    void recordSamples(VkCommandBuffer cmd, const LightBuffers& light, const Work& work);
    /// Tells whether the CPU can do without the device, where it traces: this holds where all polygons are
    /// sampled.
    bool onCpu(uint32_t group) const { return groups_[group].all; }
    /// Samples, traces and gathers on the CPU, at once; the light goes where that of recordGather goes.
    PointTimes traceOnCpu(const LightBuffers& light, const Work& work, const PointsOnCpu& on) const;
    /// Returns the segments to the points; `rays` is as in SegmentWork.
    SegmentWork segments(const LightBuffers& light, const Work& work, const vk::Buffer& rays) const;
    /// Adds to sums, vec4[kReplicates][patches], and updates direct, vec4 per patch: their mean after
    /// samplePass + 1 sample passes.
    void recordGather(VkCommandBuffer cmd, const LightBuffers& light, const Work& work,
                      const vk::Buffer& sums, const vk::Buffer& direct) const;

    /// Tells whether patches pick some of a group's polygons, as there are many.
    bool picks(uint32_t group) const { return !groups_[group].all; }

    /// Every patch samples all of so few polygons of all lights together; of more, each patch picks some in
    /// every sample pass. Picks tell nothing of where single lights are seen: 128 panels of a hall took 1.9
    /// times the rays that all of them take.
    static constexpr uint32_t kAllEmitters = 256;
    /// Light by light all of so few are sampled. Picks take fewer rays of a sample pass, but leave noise
    /// where some polygons are seen and others are hidden: lamps of up to 12 polygons took 1.4 to 4 times the
    /// rays, and of 32 2.5 times; of 128 half as many, in 1.1 times the time on a GPU, where a town's lamps
    /// of 100 took 0.7 times the time.
    static constexpr uint32_t kAllOfLight = 64;
    /// Each patch finds what all polygons of a light bring without shadows, where these are no more.
    static constexpr uint32_t kMostOfWhole = 1024;
    /// Returns the bytes of its buffers for groups of at most so many polygons.
    static uint64_t bytes(uint32_t chunkCount, bool software, const Desc& desc, uint32_t polygons);

private:
    /// The points that a patch takes of a group in a sample pass.
    struct Sampling {
        uint32_t picks = 0;  // of mesh lights; all of them where there are few
        uint32_t points = 0; // on each picked mesh light
        bool all = true;     // pick i is mesh light i
        bool whole = false;  // Wholes serves it
        uint32_t targets() const { return picks * points; }
        uint32_t picksRoom() const { return whole || all ? 2 * picks : picks; } // with what is near
        uint32_t picksOf(uint32_t together) const { return all ? picks : picks * together; }
        uint32_t pointsOf(uint32_t together) const { return all ? points * together : points; }
    };
    static Sampling samplingOf(uint32_t polygons, const Desc& desc);
    struct Group : Sampling {
        vk::Buffer polygons, nodes; // EmitterPolygon, EmitterNode
        vk::Buffer edges;           // EmitterEdge, where Wholes serves it
        uint32_t polygonCount = 0, edgeCount = 0;
    };
    Group makeGroup(const EmitterSet& set) const;
    /// The light of one group without shadows, as far as it was asked for.
    struct Wholes {
        vk::Buffer light;                 // as of EmitterSamplesPush; none where no group wants it
        std::optional<uint32_t> group;    // whose it is
        std::vector<uint8_t> knownChunks; // marks
    };
    bool learnWholes(const Work& work);
    void findWholesOnCpu(const LightBuffers& light, const Work& work) const;
    VkDeviceAddress wholesOf(const Group& group) const { return group.whole ? wholes_.light.address() : 0; }

    const vk::Device& device_;
    Desc desc_;
    uint32_t chunkCount_, batchChunks_;
    std::vector<Group> groups_;
    Wholes wholes_;
    vk::Buffer targets_, picks_, bits_; // of one batch
    vk::ComputeProgram samples_, gather_;
};

} // namespace relume
