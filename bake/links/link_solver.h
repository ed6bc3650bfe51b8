#pragma once

#include <optional>

#include "assets/base/clock.h"
#include "bake/base/chunk_sample_passes.h"
#include "bake/direct/emitter_light.h"
#include "bake/direct/lamp_light.h"
#include "bake/direct/point_trace.h"
#include "bake/gather/chunk_senders.h"
#include "bake/gather/link_batches.h"
#include "bake/gather/radiance_pass.h"
#include "bake/gather/sample_plan.h"
#include "bake/links/direct_portions.h"
#include "bake/links/direct_submit.h"
#include "bake/links/footprint.h"
#include "bake/links/link_errors.h"

namespace relume {

/// Solves with the directional or the hybrid method. A sample pass takes a few samples of every patch: points
/// on lights (on mesh lights in hybrid only) or links. The first sample pass of links is iterated until its
/// bounces have converged; later ones start from the light so far and need one bounce each, so that light and
/// samples improve together. Chunks get sample passes of direct light of their own from the first check on
/// (direct_plan.h), and on a CPU of links, too, where that is asked for (chunk_plan.h). With a number of
/// passes given, each sample pass starts from nothing and has just so many bounces. The mean over sample
/// passes is the result; the spread of the replicates is its error.
class LinkSolver final : public Solver {
public:
    /// Throws Error.
    LinkSolver(const SolverInput& input, const SolverSettings& settings);

    void step() override;
    /// Returns direct and (smoothed) indirect light; w is the standard error.
    const std::vector<glm::vec4>& light() override;
    std::vector<float> errors() override; // standard errors
    SolverState state() override;
    void collect() override;
    std::vector<StatePart> stateParts() override;
    void restore(const SolverState& state) override;

    void setPriority(std::vector<uint8_t> chunkSeen) override;
    bool passBoundary() const override { return done_ || state_.stage == Stage::Plan; }
    void abortPass() override;
    LiveLight liveLight() override;

    static constexpr uint32_t kMaxSamples = kMaxSamplesOfPatch;

private:
    using Stage = LinkState::Stage;
    LinkRules rules() const;
    void plan();
    bool planChunks();
    void begin(Stage stage);
    void beginOrder();
    void endPass();
    /// Returns the scales of chunks, where these have sample passes of their own.
    const vk::Buffer* scales() const { return state_.hasScales() ? &kit_.buffers.scales : nullptr; }
    void uploadScales();
    ChunkSamplePasses& samplePassesOf(Stage stage) {
        return stage == Stage::Direct ? directSamplePasses_ : linkSamplePasses_;
    }
    /// Tells whether there is direct light: of mesh lights, which hybrid samples, or of analytic lights.
    bool hasDirect() const { return emitters_.rays(0) > 0 || !lamps_.empty(); }
    const vk::Buffer* direct() const { return hasDirect() ? &kit_.buffers.direct : nullptr; }
    void directBatch();
    /// Sample passes that follow each other, some of which may be made at once.
    struct SamplePasses {
        uint32_t first = 0, count = 1;
    };
    void traceDirect(const DirectPortion& portion, SamplePasses samplePasses, DirectSubmit& submit);
    template<typename Lights>
    void traceGroup(Lights& lights, typename Lights::Work work, DirectSubmit& submit);
    void linkBatch();
    void complete(LinkBatches::Portion& portion) const;
    bool wantsDistances() const {
        return kit_.buffers.distances && state_.linkSamplePasses == 0 && state_.last;
    }
    void recordRadiance(VkCommandBuffer cmd);
    void shareRadiance();
    void beginBounce(bool sent = false);
    void interpolate();
    void carry();
    void endBounce();
    uint32_t chunksOfStage() const;
    const std::vector<uint8_t>& seenOfStage() const;
    void check();
    void resolve();
    void learn(const shader::ResolveSums& sums, const LinkErrors::Local& local);

    // These serve a viewer and are in link_result.cpp, with all that tells of the result.
    void look();
    std::vector<ChunkRange> showUnfinished();
    const vk::Buffer& sumsOfStage() const;
    void recordUndo(VkCommandBuffer cmd);
    void undo();

    EmitterLight emitters_; // one group; hybrid's
    glm::vec3 sky_;         // radiance that links bring [cd/m^2]; 0: none, or lamps_ has it
    LampLight lamps_;
    CoarsePatches coarse_; // empty: links start at all patches
    LinkKit kit_;          // seen: chunks of patches that come first
    LinkBatches batches_;
    LinkErrors errors_;
    ChunkSenders senders_; // of patches where links start
    LinkSchedule schedule_;
    std::optional<Footprints> footprints_;
    /// The directions of DirectionSet::Lec.
    struct {
        uint32_t count = 0;
        vk::Buffer points; // vec2[count]
    } disc_;
    RadiancePass radiancePass_;
    bool sendsOnHost_; // the CPU makes what patches send after a bounce
    LinkState state_;
    ChunkSamplePasses directSamplePasses_, linkSamplePasses_;
    DirectPlan directPlan_;
    ChunkSamplePasses::Pass pass_;       // under way
    std::vector<uint8_t> seenReceivers_; // chunks of the coarser grid that come first
    DirectPortions directPortions_;
    bool gridLimits_ = false;      // more samples are of no use
    bool stale_ = true;            // light_ is behind the sums
    std::vector<glm::vec4> light_; // empty: not read back yet
    /// Keeps what a viewer has seen. Before the first solution `result` holds what there is, later the
    /// results of sample passes.
    struct Live {
        uint64_t version = 0;
        bool all = true;                  // result is behind the light that bounces
        std::vector<ChunkRange> ranges;   // of the unfinished bounce, not in result yet
        uint32_t resolves = 0, shown = 0; // results with a solution; as of the last call
        bool lit = false; // there was light to look at, which does not go when the camera turns
        bool complete = false, asked = true;
        Clock::time_point looked;            // when the last look began
        double cost = 0;                     // of that look [s]
        uint32_t samplePasses = 0;           // sample passes at that look
        std::optional<SmoothingWidth> width; // for the next one; else the solver's
        bool undoable = false;               // what `undo` goes back to is there
    };
    Live live_;
    vk::Buffer undo_; // vec4[kReplicates][patches]; none where `rows` serves
};

} // namespace relume
