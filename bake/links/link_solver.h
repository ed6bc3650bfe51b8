#pragma once

#include "assets/base/clock.h"
#include "bake/base/batch_rate.h"
#include "bake/base/settling.h"
#include "bake/direct/emitter_light.h"
#include "bake/direct/lamp_light.h"
#include "bake/gather/link_passes.h"
#include "bake/gather/radiance_pass.h"
#include "bake/gather/smoothing_width.h"
#include "bake/links/footprint.h"
#include "bake/vk/commands.h"

#include <optional>

namespace relume {

/// Solves with the directional or the hybrid method. A sample pass takes a few samples of every patch: points
/// on lights (on mesh lights in hybrid only) or links. The first sample pass of links is iterated until its
/// bounces have converged; later ones start from the light so far and need one bounce each, so that light and
/// samples improve together. With a number of passes given, each sample pass starts from nothing and has just
/// so many bounces. The mean over sample passes is the result; the spread of the replicates is its error.
class LinkSolver final : public Solver {
public:
    /// Throws Error.
    LinkSolver(const SolverInput& input, const SolverSettings& settings);
    /// Returns the device bytes of its buffers, for patches in so many chunks.
    static uint64_t bytes(uint32_t chunkCount, bool software, const SolverSettings& settings);

    void step() override;
    /// Returns direct and (smoothed) indirect light; w is the standard error.
    const std::vector<glm::vec4>& light() override;
    std::vector<float> errors() override; // standard errors
    SolverState state() override;
    std::vector<StatePart> stateParts() override;
    void restore(const SolverState& state) override;

    void setPriority(std::vector<uint8_t> chunkSeen) override;
    bool passBoundary() const override { return done_ || state_.stage == Stage::Plan; }
    void abortPass() override;
    LiveLight liveLight() override;

    /// Beyond so many directions per patch no error is worth the time.
    static constexpr uint32_t kMaxSamples = 65536;

private:
    enum class Stage : uint32_t { Plan, Direct, Links };
    /// Everything that decides what comes next, except for the sums, the light and the order of chunks.
    struct State {
        Stage stage = Stage::Plan;
        uint32_t directRounds = 0, linkRounds = 0; // finished
        uint32_t bounce = 0;                       // of the current sample pass
        uint32_t nextCheck = 0;                    // sample passes of both kinds before the next check
        bool last = false;                         // this bounce is the sample pass's last one: it counts
        double change = 0;                         // RMS of the last bounce [cd/m^2]
        double ratio = 0;                          // of the last two changes
        double iterationError = 1, directVariance = 0, indirectVariance = 0,
               coarseVariance = 0; // of the light, R, G and B of all patches together
        SmoothingWidth width;
        uint32_t directAtCheck = 0, linksAtCheck = 0; // sample passes behind these variances
        Settling settling;                            // of the first sample pass, then of the result
    };

    void makeDisc();
    void plan();
    void begin(Stage stage);
    uint32_t roundsWanted() const;
    uint32_t footprintSamples() const;
    bool linksDone() const;
    bool directDone() const;
    bool enoughRounds() const;
    bool wantsDirect() const;
    /// Tells whether there is direct light: of mesh lights, which hybrid samples, or of analytic lights.
    bool hasDirect() const { return emitters_.rays(0) > 0 || !lamps_.empty(); }
    void directBatch();
    void linkBatch();
    void linksAtOnce(const ClosestWork* closest, const LinkGatherPass::Work& work);
    void linksBySubmit(const ClosestWork* closest, const LinkGatherPass::Work& work);
    bool wantsDistances() const { return buffers_.distances && state_.linkRounds == 0 && state_.last; }
    void recordRadiance(VkCommandBuffer cmd);
    void beginBounce();
    void interpolate();
    void endBounce();
    uint32_t chunksOfStage() const;
    void measureChange();
    void check();
    void resolve();
    shader::ResolveSums resolveOnce(double sigma);
    double coarseVariance(double patches);
    void learn(const shader::ResolveSums& sums);
    ChunkRange nextRange(const BatchRate& rate, uint32_t most) const;
    const std::vector<uint8_t>& seenOfStage() const;

    // These serve a viewer and are in link_live.cpp.
    bool hasSolution() const;
    void look();
    std::vector<ChunkRange> showUnfinished();
    const vk::Buffer& sumsOfStage() const;
    void recordUndo(VkCommandBuffer cmd);
    void undo();

    const SolverInput input_;
    SolverSettings settings_;
    bool hybrid_;
    uint32_t linksOfRound_;
    EmitterLight emitters_; // one group; hybrid's
    LampLight lamps_;
    CoarsePatches coarse_; // empty: links start at all patches
    LinkBuffers buffers_;
    std::optional<Footprints> footprints_;
    vk::Buffer disc_; // vec2[discCount_] of DirectionSet::Lec
    uint32_t discCount_ = 0;
    RadiancePass radiancePass_;
    LinkGatherPass gatherPass_;
    ResolvePass resolvePass_;
    vk::Commands commands_;
    vk::Timestamps timestamps_;
    State state_;
    ChunkOrder order_;                                 // of the sample pass's chunks
    std::vector<uint8_t> seenPatches_, seenReceivers_; // chunks that come first
    BatchRate directRate_, traceRate_, gatherRate_;
    std::vector<uint32_t> senders_; // of each chunk with links: patches that take part
    bool gridLimits_ = false;       // more samples are of no use
    bool stale_ = true;             // light_ is behind the sums
    std::vector<glm::vec4> light_;  // empty: not read back yet
    /// Keeps what a viewer has seen. Before the first solution `result` holds what there is, later the
    /// results of sample passes.
    struct Live {
        uint64_t version = 0;
        bool all = true;                  // result is behind the light that bounces
        std::vector<ChunkRange> ranges;   // of the unfinished bounce, not in result yet
        uint32_t resolves = 0, shown = 0; // results with a solution; as of the last call
        bool complete = false, asked = true;
        Clock::time_point looked;            // when the last look began
        double cost = 0;                     // of that look [s]
        uint32_t rounds = 0;                 // sample passes at that look
        std::optional<SmoothingWidth> width; // for the next one; else the solver's
        bool undoable = false;               // what `undo` goes back to is there
    };
    Live live_;
    vk::Buffer undo_;             // vec4[kReplicates][patches]; none where `rows` serves
    std::vector<uint8_t> traced_; // per chunk whose links are kept: whether this sample pass traced them
};

} // namespace relume
