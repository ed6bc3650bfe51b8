#pragma once

#include "bake/gather/radiance_pass.h"
#include "bake/pairs/pair_bits.h"
#include "bake/pairs/pair_lamps.h"
#include "bake/pairs/pair_light.h"
#include "bake/pairs/pair_senders.h"
#include "bake/pairs/pair_view.h"
#include "bake/ranks/chunk_deal.h"
#include "bake/solver/solver.h"
#include "bake/vk/commands.h"

namespace relume {

/// Tells where a pair method stands; with ligOut and the rows that are left it is all that a bake needs to go
/// on at a super-block's border. Checkpoints hold it as it is.
struct PairState {
    uint32_t lampSamplePasses = 0; // finished sample passes of analytic lights, before the first pass
    uint32_t lampChunk = 0;        // of the next one, the first chunk that is left
    uint32_t passes = 0;           // finished
    bool inPass = false;           // then:
    uint32_t row = 0, column = 0;  // the next super-block; symmetric: in either order
    uint32_t unit = 0;             // 0: it is at a border
    uint64_t ringTurn = 0;         // super-blocks of the pass that were not kept
    double lastChange = 0;         // RMS [cd/m^2] of the last pass
    double threshold = 0;          // of the quad-tree in this pass
    BounceConvergence convergence;
};

/// Solves with the pair methods. A pass gathers every patch's light from all senders and adds one bounce;
/// ligIn and ligOut swap between passes. Where the patches themselves send, visibility of a pair is traced
/// once and serves both ends. Bits may be kept for later passes. Sums run over super-blocks of 1024 x 1024
/// pairs in a fixed order. Of several processes each one does the super-blocks that give light to its own
/// rows of them, in the same order, and all bring each other their rows' light at the end of a pass.
class PairSolver final : public Solver {
public:
    /// Throws Error.
    PairSolver(const SolverInput& input, const SolverSettings& settings);

    void step() override;
    uint64_t raysSoFar() override; // asks the device
    const std::vector<glm::vec4>& light() override { return solved_.light(); }
    std::vector<float> errors() override { return solved_.errors(); } // by what the last pass changed
    SolverState state() override;
    std::vector<StatePart> stateParts() override;
    void restore(const SolverState& state) override;

    void setPriority(std::vector<uint8_t> chunkSeen) override;
    bool passBoundary() const override {
        const bool inLamps = !lamps_.done() && lamps_.begun();
        return done_ || !(walk_.inPass() || inLamps);
    }
    void abortPass() override;
    LiveLight liveLight() override;

private:
    bool symmetric() const { return senders_.kind() == SenderKind::Patches; }
    bool bothEnds() const { return settings_.transport.rtrad && symmetric(); }
    PairPlan::Desc extent() const;
    void lampBatch();
    void beginPass();
    PairPlan plan();
    void run(const PairBatch& batch);
    void trace(VkCommandBuffer cmd, const PairBatch& batch, const PairBits::Places& places);
    void endPass();
    void shareRows(const vk::Buffer& light);
    void shareCounters();
    void clearCounters();
    void countRays();
    uint64_t countedRays(uint32_t half);

    const vk::Device& device_;
    const PatchSet& patches_;
    LightBuffers& light_;
    Tracer& tracer_;
    SolverSettings settings_;
    Ranks& ranks_;
    ChunkDeal deal_; // of rows of super-blocks, in place of chunks
    PairSenders senders_;
    PairLamps lamps_;
    RadiancePass radiancePass_;
    GatherPass gatherPass_;
    FinishPass finishPass_;
    vk::Commands commands_;
    vk::Timestamps timestamps_;
    PairBuffers buffers_;
    PairBits bits_;
    vk::Buffer rays_; // uint[2][kRayCounters]: rays to bits that are kept, and to others
    PairWalk walk_;
    PairTally tally_; // of the pass under way
    PairRates rates_;
    PairLight solved_;
    PairView view_;
    double threshold_; // of the quad-tree in this pass
    /// Counters as all ranks have had them last.
    struct {
        uint64_t rays = 0, saved = 0, pairs = 0;
    } shared_;
};

} // namespace relume
