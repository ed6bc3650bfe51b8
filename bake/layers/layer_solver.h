#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "bake/layers/bounce_job.h"
#include "bake/layers/composite_report.h"
#include "bake/layers/direct_job.h"
#include "bake/layers/layer_carry.h"
#include "bake/layers/layer_mixer.h"
#include "bake/layers/layer_schedule.h"
#include "bake/layers/relinker.h"

namespace relume {

/// Solves with the hybrid method, light by light: each light has a layer, its light for a unit of its weight
/// with all bounces, and what is shown is the sum of weights times layers. Lights beyond the memory share
/// layers (bake/layers/light_groups.h), in which they are weighed before they bounce. A layer's level says
/// how many sample passes of direct light and of links it is made of. Its bytes depend on nothing but that,
/// its cache key, geometry and surfaces: not on weights, on other lights, or on what was edited before.
class LayerSolver final : public Solver {
public:
    /// With `carry` it goes on with what another solver has left. Throws Error.
    LayerSolver(const SolverInput& input, const SolverSettings& settings, const LayerCarry* carry = nullptr);
    ~LayerSolver() override;

    void step() override;
    /// Returns the sum of all layers; w is its standard error if those of the layers were independent.
    const std::vector<glm::vec4>& light() override { return mixer_.light(layers()); }
    std::vector<float> errors() override;
    void setPriority(std::vector<uint8_t> chunkSeen) override;
    bool passBoundary() const override { return done_ || !isBusy(); }
    void abortPass() override;
    uint64_t raysSoFar() override; // asks the device
    LiveLight liveLight() override;
    SolverState state() override;
    std::vector<StatePart> stateParts() override;
    void restore(const SolverState& state) override;

    /// Gives up the layers and links, for another solver to go on with. It is of no use afterwards.
    FormerLayers release();

    /// Tells whether there is memory for layers of so many analytic lights beside those of the other lights,
    /// grouped or not.
    bool holds(size_t lamps) const;

    /// Returns what the user sees and changes; it is valid until the next step() or edit().
    const std::vector<std::unique_ptr<Layer>>& layers() const { return store_.layers(); }
    /// Returns the layer's share of the composite's light, as it is weighed now.
    double shareOf(const Layer& layer) const;
    /// Returns a layer's result for a unit of its weight, vec4 per patch, in the memory of `light`.
    std::vector<glm::vec4> layerLight(const Layer& layer, std::vector<glm::vec4> light = {}) const;

    /// Takes up that the scene which the solver was made with has been changed: its lights, its sky, the
    /// colours of its materials (with the patches', as Baker::apply has it) or the switches. Weights count at
    /// once, or in the next sum of all lights while all are seen in one. Layers whose cache key changed are
    /// made anew once the first level of the layer under way is through, so that a light that is dragged is
    /// seen. `repainted` says that materials were given other patterns, too.
    void edit(const LightMix& mix, bool repainted = false);
    /// Tells whether what is shown is of the newest colours of surfaces and places of objects: layer by
    /// layer, or all in one.
    bool current() const { return !edited_ && schedule_.isWhole(layers(), now()); }
    /// Takes up that objects have moved, as patches and tracer have it by now; edit() is to be told, too.
    /// Needs atRest().
    void moveObjects(const ObjectMove& move);
    /// Tells whether base colours and objects may be changed now: no layer is on its way to its first level,
    /// unless the sum of all lights is shown, that sum is not under way either, and a viewer was shown what
    /// was changed before.
    bool atRest() const { return schedule_.atRest(layers(), now()); }

    /// Each light gets few points per patch and sample pass, so that a light that moves is seen soon.
    static constexpr uint32_t kPointsOfSamplePass = LayerLights::kPoints;

private:
    bool isBusy() const { return !std::holds_alternative<std::monostate>(job_); }
    ScheduleState now() const;

    // Steps
    void batch();
    void begin(const LayerSchedule::BeginLayer& next);
    void endDirectBatch(DirectJob::End end);
    void endRepair();
    void beginBounces(Layer& leader, LayerLevel target);
    void bounceBatch();
    void finishLevel(const BounceJob::Lane& lane, uint32_t index, uint32_t gathers);
    LevelSums resolveLevel(const BounceJob::Lane& lane, uint32_t index);
    void showLevel(Layer& layer);
    void endStandIn();

    // The sum of all lights
    bool canSum() const { return schedule_.canSum(layers(), mixer_.showsSum()); }
    bool wantsSum() const { return schedule_.wantsSum(layers(), mixer_.showsSum()); }
    void beginSum();

    // Edits, in layer_adopt.cpp
    void weigh();
    void adopt();
    void adoptMove();
    void adoptLayers();
    std::vector<WantedLayer> wantedNow() const;
    void takeOver(const LayerCarry& carry);
    void inherit(const Layer& from, Layer& to) const;
    void tellGroups();

    LinkKit kit_;
    LayerPass layerPass_;
    ChunkSenders senders_;
    LayerSchedule schedule_;
    LayerStore store_;
    LayerLights lights_;
    PenumbraMap penumbra_;
    std::unique_ptr<LayerGather> gather_;
    LinkBatches batches_;
    DirectJob::Tools directTools_;
    BounceJob::Tools bounceTools_;
    LayerMixer mixer_;
    CompositeReport report_;
    Relinker relinker_;
    std::variant<std::monostate, DirectJob, BounceJob> job_;

    SceneStates states_;
    LightMix mix_;
    bool edited_ = false; // an edit waits to be adopted
    bool unseen_ = false; // base colours or objects were changed, and there is no whole picture of it yet
    bool sumDue_ = false;
    std::unique_ptr<Layer> sum_;      // of all lights with their weights: direct light, and what came of it
    std::optional<ObjectMove> moved_; // an edit of objects that waits to be adopted
    bool reachMoved_ = false;         // rays to suns and the sky end elsewhere since objects moved
    std::string toldGroups_;          // what the log was told last
};

} // namespace relume
