#pragma once

#include "bake/direct/lamp_light.h"
#include "bake/direct/point_trace.h"
#include "bake/vk/commands.h"

namespace relume {

/// Makes the direct light of analytic lights, which no patch sends. It is found once, before the first pass,
/// and each pass adds to it.
class PairLamps {
public:
    /// Tells where it stands.
    struct Place {
        uint32_t samplePasses = 0; // finished sample passes
        uint32_t chunk = 0;        // of the next one, the first chunk that is left
    };
    /// Makes that of these chunks (ascending), of which there may be none.
    PairLamps(const vk::Device& device, const Scene& scene, const PatchSet& patches,
              std::vector<uint32_t> chunks);

    bool empty() const { return lamps_.empty(); }
    bool done() const;
    /// Tells whether some of it is there.
    bool begun() const { return place_.samplePasses > 0 || place_.chunk > 0; }
    double fraction() const; // done
    /// Starts over, from no light.
    void clear(vk::Commands& commands);
    struct Batch {
        PointTracer on;
        const LightBuffers& light;
        const vk::Buffer& rays; // SegmentWork::rays
        double aim = 0;         // of the batch [ms]
    };
    /// Does the next batch and returns what it took.
    PointTimes batch(const Batch& batch);

    const vk::Buffer& direct() const { return direct_; } // vec4 per patch
    const vk::Buffer& sums() const { return sums_; }     // vec4[kReplicates][patches]
    const Place& place() const { return place_; }
    void resume(const Place& place) { place_ = place; }

private:
    ChunkRange next() const;

    uint32_t allChunks_;
    std::vector<uint32_t> chunks_; // that it makes
    LampLight lamps_;
    vk::Buffer sums_, direct_; // none without lights
    vk::Buffer list_;          // chunks_ for kernels; none where these are all
    double rate_ = 0;          // [chunks/ms], 0: not measured yet
    Place place_;
};

} // namespace relume
