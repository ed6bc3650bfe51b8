#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "bake/gather/sample_plan.h"
#include "bake/layers/composite.h"
#include "bake/layers/layer.h"

namespace relume {

/// Says what layers cost, in links: a segment towards a light is one. Links are traced once for all layers,
/// as far as there is memory, but gathered for each in all its bounces.
struct LayerCosts {
    double picked = 1.0; // of a segment to one of many polygons, which is picked
    double gather =
        0.15; // what a layer pays for links itself, as a share of tracing them (two CPU cores, three bounces)
};
/// These are a GPU's, where layers bounce side by side, and picks take as long as segments (H100: 4 and 0.02
/// in the atrium, 0.01 in the town).
constexpr LayerCosts kGpuLayerCosts{.picked = 3.0, .gather = 0.02};

/// Holds what a schedule goes by for a whole bake.
struct ScheduleRules {
    uint32_t pointsOfSamplePass = 4; // points per patch and sample pass of direct light
    uint32_t linksOfSamplePass = 16; // links per patch and sample pass
    uint32_t samples = 0;            // per patch, at most; 0: as many as the error needs
    uint32_t passes = 0;             // bounces, the direct light included; 0: until they have converged
    double error = 0.01;             // relRMSE that the composite is to have; 0: it may have any
    double localError = 0;           // that the composite is to have (its 95th percentile); 0: any
    double layerError = 0; // relRMSE that each layer is to have by itself; 0: any. Without all three, all
                           // samples are taken
    bool live = false;     // a viewer looks
    bool together = false; // layers bounce side by side
    LayerCosts costs = {};
};

/// Holds what is under way while the schedule is asked, besides the layers.
struct ScheduleState {
    /// The sum of all lights: an edit that changes every layer is seen by it at first.
    struct Sum {
        bool due = false;   // it is to be made
        bool shown = false; // it is shown in place of the layers
    };
    Sum sum;
    bool unseen = false; // colours or objects have changed, and there is no whole picture of it yet
    std::optional<uint32_t> relinkSamplePass; // sample pass whose links follow objects that moved now
    struct Nothing {};
    struct SumJob {};
    struct LayerJob {
        bool hasLevel = false; // the layer that leads the job
    };
    std::variant<Nothing, SumJob, LayerJob> job;
};

/// Decides what a layered bake does next. It is a pure function of the layers and of what is under way; the
/// layers' buffers play no part.
class LayerSchedule {
public:
    using Layers = std::vector<std::unique_ptr<Layer>>;

    explicit LayerSchedule(const ScheduleRules& rules) : rules_(rules) {}

    // These decide about levels.
    /// Returns what a light that is moved shows at once: two sample passes, the second for its penumbra.
    LayerLevel firstLevel() const;
    /// Returns the level beyond which no error is worth the time.
    LayerLevel lastLevel() const;
    /// Tells whether this is the first level and others follow.
    bool isHasty(LayerLevel target) const;
    /// Decides for each layer how far it is to go, by its share of the composite as it is weighed now: sets
    /// its plan. It is to be called whenever a level has changed and, as `weighedAnew`, when
    /// weights have, or which layers there are; what was decided before counts no more then.
    /// `local` is the composite's local error, where it is known; `products` are as for compositeOf.
    void apportion(const Layers& layers, bool weighedAnew = false, const CompositeLocal* local = nullptr,
                   SketchProducts* products = nullptr) const;
    /// Tells whether each layer has the level that it was to have: how far all go is decided anew then.
    bool areTogether(const Layers& layers) const;
    /// Returns the level to be made now. One that was there before is made in the steps that it was made in.
    LayerLevel targetOf(const Layer& layer) const;

    // These decide about steps.
    struct Done {};
    struct Relink {};   // links follow objects that moved
    struct Continue {}; // with the job under way
    struct BeginSum {}; // of all lights
    struct BeginLayer {
        size_t layer = 0;
        LayerLevel target;
        bool directAlone = false; // bounces wait for other layers to come along
    };
    using Step = std::variant<Done, Relink, Continue, BeginSum, BeginLayer>;
    Step next(const Layers& layers, const ScheduleState& state) const;
    /// Tells whether the job under way is to be dropped before that: the sum of all lights is due.
    static bool drops(const ScheduleState& state) {
        return state.sum.due && std::holds_alternative<ScheduleState::LayerJob>(state.job);
    }

    /// Tells whether an edit is taken now: what comes again and again, sixty times a second, waits until the
    /// picture of the one before is shown.
    bool takesEdits(const Layers& layers, const ScheduleState& state) const;
    /// Tells whether base colours and objects may be changed now.
    bool atRest(const Layers& layers, const ScheduleState& state) const;
    /// Returns others that are to go on and want as many links, gathered alike.
    std::vector<size_t> companions(const Layers& layers, size_t index, LayerLevel target) const;

    // These tell what is seen.
    /// Tells whether the sum of all lights is wanted: what is shown stays until all layers are there. One
    /// layer alone is seen as soon itself, unless it takes more links.
    bool wantsSum(const Layers& layers, bool shown) const;
    /// Tells whether it can be made, too: all that shines has direct light, made for where objects are. Where
    /// nothing is shown yet, that of the sun and the sky will do for a first one.
    bool canSum(const Layers& layers, bool shown) const;
    /// Returns the sample passes of links that the sum takes.
    uint32_t sumSamplePasses() const;
    /// Returns those that the sum of these layers takes: no more than the deepest of them has.
    uint32_t sumSamplePasses(const Layers& layers) const;
    /// Tells whether what is shown is of the last edit that was adopted.
    bool isWhole(const Layers& layers, const ScheduleState& state) const;
    /// Returns a layer whose direct light is to be repaired before any layer goes on, those whose repair has
    /// not begun first; nothing where there is none or nobody looks.
    std::optional<size_t> dirtyLayer(const Layers& layers) const;
    /// Returns how far the composite is off, as relRMSE (compositeOf), and whether all that was asked for is
    /// reached.
    struct Told {
        double error = 1;
        bool converged = false;
    };
    Told told(const Layers& layers, std::optional<double> localError = {},
              SketchProducts* products = nullptr) const;

private:
    Step nextLevelStep(const Layers& layers, const ScheduleState& state) const;
    bool takesAll() const { return rules_.error <= 0 && rules_.localError <= 0 && rules_.layerError <= 0; }
    bool isOver(const Layer& layer) const { return layer.level == lastLevel() || layer.light <= 0; }
    bool isGoodEnough(const Layer& layer) const;
    SampledPart directPart(const Layer& layer, double variance) const;
    SampledPart linkPart(const Layer& layer, double variance, size_t sharers) const;
    LayerLevel levelByItself(const Layer& layer) const;
    LayerLevel levelAfter(LayerLevel level) const;
    struct Standing;
    std::vector<LayerLevel> levelsFor(const Standing& standing, const CompositeLocal* local,
                                      double share) const;
    std::vector<LayerLevel> levelsTogether(const Standing& standing, const CompositeLocal* local) const;
    std::optional<size_t> unlitLayer(const Layers& layers, const ScheduleState& state) const;
    std::optional<size_t> nextLayer(const Layers& layers) const;
    std::optional<size_t> directFirst(const Layers& layers, size_t index) const;
    static bool canBeginWithDaylight(const Layers& layers);
    bool sumComesFirst(const Layers& layers, const ScheduleState& state) const;

    ScheduleRules rules_;
};

} // namespace relume
