#pragma once

#include <optional>
#include <vector>

#include "assets/base/clock.h"
#include "bake/base/batch_rate.h"
#include "bake/base/settling.h"
#include "bake/direct/emitter_light.h"
#include "bake/direct/lamp_light.h"
#include "bake/gather/link_cache.h"
#include "bake/gather/link_passes.h"
#include "bake/gather/radiance_pass.h"
#include "bake/layers/layer_bounces.h"
#include "bake/layers/layer_passes.h"
#include "bake/layers/object_move.h"
#include "bake/surface/tile_parts.h"
#include "bake/vk/commands.h"

namespace relume {

/// Solves with the hybrid method, light by light: each light has a layer, its light for a unit of its weight
/// with all bounces, and what is shown is the sum of weights times layers. Lights beyond the memory share
/// layers (bake/layers/light_groups.h), in which they are weighed before they bounce. A layer's level says
/// how many sample passes of direct light and of links it is made of. Its bytes depend on nothing but that,
/// its cache key, geometry and surfaces: not on weights, on other lights, or on what was edited before.
class LayerSolver final : public Solver {
public:
    /// Throws Error.
    LayerSolver(const SolverInput& input, const SolverSettings& settings);
    ~LayerSolver() override;

    void step() override;
    /// Returns the sum of all layers; w is an upper bound of the standard error.
    const std::vector<glm::vec4>& light() override;
    std::vector<float> errors() override;
    void setPriority(std::vector<uint8_t> chunkSeen) override;
    bool passBoundary() const override { return done_ || !work_; }
    void abortPass() override;
    uint64_t raysSoFar() override; // asks the device
    LiveLight liveLight() override;
    SolverState state() override;
    std::vector<StatePart> stateParts() override;
    void restore(const SolverState& state) override;

    /// Tells in one line why so many bytes are not enough for layers of the scene's lights, not even for
    /// groups of them, and what helps; returns "" where they are enough.
    static std::string problem(const Scene& scene, const PatchSet& patches, uint64_t bytes);
    /// Tells whether there is memory for layers of so many analytic lights beside those of the other lights,
    /// grouped or not.
    bool holds(size_t lamps) const;

    /// Returns what the user sees and changes; it is valid until the next step() or edit().
    const std::vector<std::unique_ptr<Layer>>& layers() const { return layers_; }
    /// Returns a layer's result for a unit of its weight, vec4 per patch.
    std::vector<glm::vec4> layerLight(const Layer& layer) const;

    /// Takes up that the scene which the solver was made with has been changed: its lights, its sky, the
    /// colours of its materials (Baker::updateMaterials) or the switches. Weights count at once, or in the
    /// next sum of all lights while all are seen in one. Layers whose cache key changed are made anew once
    /// the first level of the layer under way is through, so that a light that is dragged is seen.
    void edit(const LightMix& mix);
    /// Tells whether what is shown is of the newest colours of surfaces and places of objects: layer by
    /// layer, or all in one.
    bool current() const;
    /// Takes up that objects have moved (Baker::moveObjects); edit() is to be told, too. Needs atRest().
    void moveObjects(const ObjectMove& move);
    /// Tells whether base colours and objects may be changed now: no layer is on its way to its first level,
    /// unless the sum of all lights is shown, that sum is not under way either, and a viewer was shown what
    /// was changed before.
    bool atRest() const { return takesEdits() && !(settings_.live && unseen_); }

    /// Each light gets few points per patch and sample pass, so that a light that moves is seen soon.
    static constexpr uint32_t kPointsOfRound = shader::kReplicates;

private:
    // A submit holds at most so many portions of a pass: marks of time are between them.
    static constexpr uint32_t kMostPortions = 32;

    enum class Stage : uint8_t { Direct, Bounces, Gather };
    /// One of the layers that bounce together.
    struct Lane {
        size_t layer = 0;
        LayerLevel target;
        bool live = true;      // goes on in this stage
        uint32_t look = 0;     // after so many bounces the CPU looks whether they have converged
        uint32_t looked = 0;   // after so many it last did
        uint64_t gathered = 0; // links, in all its bounces
        double change = 0, ratio = 0, iterationError = 1;
    };
    /// A layer on its way to the next level.
    struct Work {
        size_t layer = 0;
        bool sum = false; // not a layer, but all of them together
        LayerLevel target;
        bool directAlone = false; // bounces wait for other layers to come along
        std::vector<Lane> lanes;  // once it bounces: itself, and others that bounce along
        Stage stage = Stage::Direct;
        uint32_t round = 0;             // sample pass of direct light, or of links that are gathered
        uint32_t part = 0;              // of Layer::parts, within a sample pass of direct light
        std::vector<uint8_t> penumbra;  // chunks with a part of Layer::penumbra; empty: not known yet
        uint32_t bounce = 0;            // finished ones, over the links of the first sample pass
        uint32_t gathers = 0;           // finished ones, over the links of all sample passes
        bool begun = false;             // a batch of this pass has been made
        bool lit = false;               // what patches send is that of ligIn
        std::optional<uint32_t> mended; // step of Layer::directSteps; set while dirty chunks are repaired
    };
    /// Part of a pass over links.
    struct LinkPortion {
        bool trace = false; // the links are not there yet
        ChunkRange range;
        ClosestWork closest;
        LinkGatherPass::Work gather;
        std::vector<VkDeviceAddress> following; // links of later sample passes, gathered along
    };
    /// Sums over all patches: of bounces as they were smoothed, and of the result as LayerPass tells it.
    struct LevelSums {
        shader::ResolveSums indirect{};
        glm::dvec4 result{0.0};
    };
    /// The places where objects were and are, for tracers.
    struct Path {
        ObjectMove move;
        vk::Buffer boxes, changed;
    };
    /// Kept links on their way to where objects are now.
    struct Relink {
        Path early, late; // for the first earlyRounds sample passes, for the others
        uint32_t earlyRounds = 0;
        vk::Buffer list;
        BatchRate rate;
        uint32_t round = 0, chunk = 0; // next
    };

    /// A layer as the scene is to have it now.
    struct Wanted {
        LightPattern pattern;
        LightSource source; // weight: with its switches, here and of members
        std::vector<LightSource> members;

        bool isDarkGroup() const { return !members.empty() && pattern.members.empty(); }
    };
    /// Mesh lights whose direct light is sampled together.
    struct EmitterGroup {
        std::vector<EmitterChoice> choices;
        EmitterSet set;
    };

    /// The record of a layer that memory was short for: what makes its bytes again.
    struct Record {
        LightPattern pattern;
        LayerLevel level;
        std::vector<uint32_t> directSteps;
    };

    // layer_solver.cpp
    void countSenders();
    void plan();
    Layer& layerOf(const Lane& lane) const { return work_->sum ? *sum_ : *layers_[lane.layer]; }
    void begin(size_t layer, LayerLevel target, bool directAlone = false);
    void directBatch();
    template<typename Lights>
    void traceDirect(VkCommandBuffer cmd, const Lights& lights, uint32_t group, ChunkRange range,
                     uint32_t mark);
    void traceOnCpu(const LampLight::Work& work);
    uint32_t directEnd() const;
    bool nextDirect();
    bool orderRound();
    bool seekRound();
    void endFirstRound(VkCommandBuffer cmd);
    void endDirectStep(VkCommandBuffer cmd);
    void recordPenumbra(VkCommandBuffer cmd);
    void learnPenumbra();
    void setPenumbra(const Layer& layer);
    void recordPenumbraUpload(VkCommandBuffer cmd);
    std::shared_ptr<vk::Buffer> recordOwnDirect(VkCommandBuffer cmd, Layer& layer);
    void recordRayCount(VkCommandBuffer cmd);
    void countRays();
    uint32_t raysOf(const Layer& layer) const;
    ChunkRange nextRange(const BatchRate& rate, uint32_t most, double cost = 1, double done = 0) const;
    void beginPass(Stage stage);
    void recordBack(VkCommandBuffer cmd, const vk::Buffer& from, VkDeviceSize bytes, VkDeviceSize at = 0);
    void run(VkCommandBuffer cmd);

    // layer_links.cpp
    void beginBounces();
    std::vector<size_t> companions(size_t index, LayerLevel target) const;
    std::optional<size_t> directFirst(size_t index) const;
    std::vector<Lane> lanes() const;
    LinkPortion nextLinks(double most);
    void takeFollowing(LinkPortion& portion, double most);
    void linkBatch();
    bool linksAtOnce(const LinkPortion& portion);
    bool linksBySubmit(const LinkPortion& portion);
    bool knownLinksBySubmit(LinkPortion portion);
    void noteLinks(const LinkPortion& portion);
    const vk::Buffer& firstLight(const Lane& lane) const;
    void recordPassBegin(VkCommandBuffer cmd);
    void recordRadiance(VkCommandBuffer cmd);
    void recordGather(VkCommandBuffer cmd, const LinkPortion& portion);
    bool recordsPassEnd() const;
    bool recordPassEnd(VkCommandBuffer cmd);
    bool recordGatherEnd(VkCommandBuffer cmd);
    void recordPassLight(VkCommandBuffer cmd);
    void recordChanges(VkCommandBuffer cmd);
    bool isLastGather() const;
    uint32_t nextLook() const;
    bool tellsChange() const;
    void look();
    void lookAtGather();
    void learnChanges(Lane& lane, bool both);
    void learnChange(Lane& lane, const glm::dvec4& total);
    uint32_t bouncesToAim(const Lane& lane) const;
    bool wantsDistances() const;
    double iterationAim(const Lane& lane) const;

    // layer_levels.cpp
    void finishLevel(const Lane& lane);
    void recordChunkSums(VkCommandBuffer cmd, uint32_t width, VkDeviceSize at);
    LevelSums resolve(const Layer& layer, uint32_t linkRounds, double sigma);
    LevelSums resolveOnCpu(const Layer& layer, uint32_t linkRounds, double sigma) const;
    std::optional<size_t> nextLayer() const;
    LayerLevel firstLevel() const;
    bool isHasty(LayerLevel target) const;
    LayerLevel nextLevel(const Layer& layer) const;
    LayerLevel targetOf(const Layer& layer) const;
    LayerLevel lastLevel() const;
    void tellError();

    // layer_edits.cpp
    bool takesEdits() const;
    void adopt();
    std::vector<size_t*> layersUnderWay();
    void weigh();
    std::unique_ptr<Layer> makeLayer(const LightPattern& pattern) const;
    void adoptLayers(const std::vector<Wanted>& wanted);
    vk::Buffer takeBuffer(const char* name);
    void recycle(Layer& layer);
    std::unique_ptr<Layer> takeLayer(const Wanted& wanted);
    void archive(std::unique_ptr<Layer> layer);
    void remember(const Layer& layer);
    void recall(Layer& layer) const;
    void keepDirect(const Layer& from, Layer& to) const;

    // layer_groups.cpp
    uint64_t layerRoom() const;
    std::vector<Wanted> wantedLayers() const;
    void updateParts();
    void updateEmitters();
    void tellGroups();
    static bool isRegrouped(const Layer& layer, const std::vector<Wanted>& wanted);
    std::vector<bool> standsIn(const std::vector<Wanted>& wanted,
                               const std::vector<std::unique_ptr<Layer>>& taken) const;
    std::vector<bool> beginStandIn(const std::vector<Wanted>& wanted,
                                   const std::vector<std::unique_ptr<Layer>>& taken);
    void endStandIn();

    // layer_sum.cpp
    bool wantsSum() const;
    bool canSum() const;
    std::optional<size_t> unlitLayer() const;
    uint32_t sumRounds() const;
    bool sumComesFirst() const;
    bool isWhole() const;
    void beginSum();
    void showSum();
    void hideSum();

    // layer_objects.cpp
    void adoptMove();
    void relinkBatch();
    LightPlace placeOf(const LightPattern& pattern) const;
    std::vector<uint8_t> chunksOf(const LightPattern& pattern) const;
    void keepStale(const Layer& from, Layer& to) const;
    void growToParts(std::vector<uint8_t>& stale) const;
    void beginMending();
    static std::vector<ChunkRange> mendedRanges(const Layer& layer);
    void endMendingStep();
    void endMending();
    std::optional<size_t> staleLayer() const;

    // layer_mix.cpp
    std::vector<shader::LayerWeight> shares(std::optional<size_t> without, std::optional<size_t> only) const;
    uint32_t writeWeights(const std::vector<shader::LayerWeight>& list);
    void mix(const vk::Buffer& to);
    void mixForViewer();
    void changed(size_t layer);
    void allChanged();

    const SolverInput input_;
    SolverSettings settings_;
    uint32_t linksOfRound_;
    EmitterLight emitters_;
    LampLight lamps_;
    LinkBuffers buffers_;
    LinkCache links_;
    RadiancePass radiancePass_;
    LinkGatherPass gatherPass_;
    std::unique_ptr<LayerBounces> bounces_; // where the device gathers
    ResolvePass resolvePass_;
    LayerPass layerPass_;
    ChunkSumPass chunkSums_;
    TileParts parts_;
    Penumbra penumbra_;        // of the layer whose direct light is under way
    vk::Buffer newPenumbra_;   // penumbra_.lights as they are to be; none where the CPU sees these
    bool penumbraDue_ = false; // newPenumbra_ waits for the next submit
    vk::Buffer back_;          // what the CPU reads after a submit: sums per chunk, or counters of rays
    vk::Commands commands_;
    vk::Timestamps timestamps_;
    ChunkOrder order_;                // of the pass under way
    std::vector<uint8_t> seen_;       // chunks that come first
    std::vector<uint32_t> senders_;   // patches that take part, per chunk
    std::vector<uint8_t> fullChunks_; // not 0: all of its patches do, and are shown
    BatchRate directRate_, traceRate_, gatherRate_;
    bool distancesKnown_ = false; // of the links of the first sample pass

    std::vector<std::unique_ptr<Layer>> layers_; // in the order of groupLights()
    std::vector<std::unique_ptr<Layer>> former_; // kept for an undo, the newest last
    std::vector<Record> records_;                // of those that are no longer kept, the newest last
    std::vector<vk::Buffer> spare_;              // of layers that are gone, to be used again
    uint64_t layerBytes_ = 0;                    // at most, of all of them
    std::vector<EmitterGroup> emitterGroups_;    // of emitters_
    std::string toldGroups_;                     // what the log was told last
    vk::Buffer standIn_; // vec4 per patch: light of those that were grouped otherwise before
    uint64_t surfaces_ = 0, objects_ = 0;
    uint64_t objectsBefore_ = 0;      // before the newest edit
    std::optional<ObjectMove> moved_; // an edit of objects that waits to be adopted
    std::optional<Relink> relink_;
    std::unique_ptr<WorkerPool> pool_; // for the CPU's share of moves, where a GPU gathers
    bool reachMoved_ = false;          // rays to suns and the sky end elsewhere since objects moved
    std::optional<Work> work_;
    LightMix mix_;
    bool edited_ = false; // an edit waits to be adopted
    bool unseen_ = false; // base colours or objects were changed, and there is no whole picture of it yet

    std::unique_ptr<Layer> sum_; // of all lights with their weights: direct light, and what came of it
    bool sumDue_ = false, sumShown_ = false;

    vk::Buffer weights_;   // LayerWeight[]
    vk::Buffer composite_; // vec4 per patch
    vk::Buffer rest_;      // the composite without restOf_
    std::optional<size_t> restOf_;
    std::vector<size_t> changed_; // layers since the composite was made
    bool allChanged_ = false;     // all of them, and which ones there are
    bool stale_ = true;           // light_ is behind
    std::vector<glm::vec4> light_;
    uint64_t version_ = 0; // of what a viewer is shown
};

} // namespace relume
