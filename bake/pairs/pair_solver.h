#pragma once

#include "bake/base/settling.h"
#include "bake/direct/lamp_light.h"
#include "bake/gather/radiance_pass.h"
#include "bake/pairs/bits_cache.h"
#include "bake/pairs/pair_plan.h"
#include "bake/pairs/pair_senders.h"
#include "bake/solver/solver.h"
#include "bake/vk/commands.h"

namespace relume {

/// Tells where a pair method stands; with ligOut and the rows that are left it is all that a bake needs to go
/// on at a super-block's border.
struct PairState {
    uint32_t lampRounds = 0;      // finished sample passes of analytic lights, before the first pass
    uint32_t lampChunk = 0;       // of the next one, the first chunk that is left
    uint32_t passes = 0;          // finished
    bool inPass = false;          // then:
    uint32_t row = 0, column = 0; // the next super-block; symmetric: in either order
    uint32_t unit = 0;            // of it, the next one to be traced; 0 at its border
    uint64_t ringTurn = 0;        // super-blocks of the pass that were not kept
    double lastChange = 0;        // RMS [cd/m^2] of the last pass
    double threshold = 0;         // of the quad-tree in this pass
    Settling settling;
};

/// Solves with the pair methods. A pass gathers every patch's light from all senders and adds one bounce;
/// ligIn and ligOut swap between passes. Where the patches themselves send, visibility of a pair is traced
/// once and serves both ends. Bits may be kept for later passes. Sums run over super-blocks of 1024 x 1024
/// pairs in a fixed order.
class PairSolver final : public Solver {
public:
    /// Throws Error.
    PairSolver(const SolverInput& input, const SolverSettings& settings);

    void step() override;
    uint64_t raysSoFar() override; // asks the device
    const std::vector<glm::vec4>& light() override { return last_; }
    std::vector<float> errors() override; // by what the last pass changed
    SolverState state() override;
    std::vector<StatePart> stateParts() override;
    void restore(const SolverState& state) override;

    void setPriority(std::vector<uint8_t> chunkSeen) override;
    bool passBoundary() const override {
        const bool inLamps = !lampsDone() && (state_.lampRounds > 0 || state_.lampChunk > 0);
        return done_ || !(state_.inPass || inLamps);
    }
    void abortPass() override;
    LiveLight liveLight() override;

    static uint64_t bytes(uint32_t chunkCount, bool software, const SolverSettings& settings);

private:
    /// Consecutive super-blocks: the first may be traced in part already, the last may stay in part.
    struct Batch {
        std::vector<SuperBlock> supers;
        std::vector<uint32_t*> bits;
        std::vector<BitsCache::Entry*> entries; // null: not kept
        std::vector<UnitMask> traced;
        uint32_t firstUnit = 0, endUnit = 0; // of the first and, plus 256 each, of the last super-block
        uint32_t complete = 0;               // super-blocks to gather
        double tracedUnits = 0, gatheredUnits = 0;
        uint64_t pairs = 0;
        double cost = 0; // expected [ms]
    };
    void makeCache();
    void makeLamps();
    void clearLamps();
    void clearCounters();
    bool lampsDone() const;
    void lampBatch();
    void beginPass();
    void listSupers();
    Batch cutBatch();
    bool addSuper(Batch& batch, const UnitMask& units);
    uint32_t unitsThatFit(const Batch& batch, const UnitMask& missing) const;
    void nextSuper();
    void nextRow();
    uint32_t firstColumn() const;
    bool isDone(uint32_t column) const;
    SuperBlock current() const;
    void run(Batch& batch);
    void trace(VkCommandBuffer cmd, const Batch& batch);
    void learn(const Batch& batch, double traceMs, double gatherMs);
    void endPass();
    struct ChangeSums {
        double squares = 0, light = 0; // R, G and B of all patches together
        uint64_t count = 0;
    };
    void measureChange();
    ChangeSums changeOf(uint32_t first) const;
    void countRays();
    bool passDone() const { return state_.row >= plan_.superRows(); }
    uint64_t countedRays(uint32_t half);

    const vk::Device& device_;
    const PatchSet& patches_;
    LightBuffers& light_;
    Tracer& tracer_;
    SolverSettings settings_;
    PairSenders senders_;
    LampLight lamps_;
    vk::Buffer lampSums_, direct_; // vec4[kReplicates][patches]; vec4 per patch, which ligOut starts from
    double lampRate_ = 0;          // [chunks/ms], 0: not measured yet
    bool bothEnds_;                // RTRad's pairs of patches are traced from either end
    RadiancePass radiancePass_;
    GatherPass gatherPass_;
    FinishPass finishPass_;
    vk::Commands commands_;
    vk::Timestamps timestamps_;
    PairBuffers buffers_;
    BitsRing ring_; // made when it is needed
    std::unique_ptr<BitsCache> cache_;
    vk::Buffer rays_;
    PairPlan plan_;
    PairState state_;
    double msPerTraced_ = 0, msPerGathered_ = 0; // unit, measured; 0: nothing yet
    uint64_t unitsDone_ = 0, unitsKnown_ = 0;    // of the current pass; of these bits that were kept
    uint32_t superKnown_ = 0;                    // units of the current super-block, before this pass
    double keptRays_ = 0;                        // that the bits in the cache took
    std::vector<glm::vec4> last_;                // ligIn: light of the last finished pass
    std::vector<glm::vec4> before_;              // of the one before it
    float left_ = -1; // share of the last change that is still to come; negative: not known yet
    WorkerPool pool_{0};
    // These are rows of super-blocks. Where the patches themselves send, a row is all super-blocks of its
    // patches, as rows or as columns, that no earlier row had: at its end its patches have all their light.
    ChunkOrder rows_;
    std::vector<uint8_t> seenRows_; // rows that come first

    // These serve a viewer and are in pair_live.cpp.
    enum class Fresh : uint8_t { No, LigIn, LigOut };
    vk::Buffer live_;          // vec4 per patch, what is shown
    std::vector<Fresh> fresh_; // per row: where there is light that live_ has not
    uint64_t liveVersion_ = 0;
    bool complete_ = false;
};

} // namespace relume
