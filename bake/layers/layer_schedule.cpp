#include "bake/layers/layer_schedule.h"

#include "bake/base/bounce_convergence.h"
#include "bake/layers/composite.h"
#include "bake/layers/layer_bounces.h"

#include <algorithm>

namespace relume {
namespace {

// A level aims at this share of the variance that is allowed: a little too much costs bounces of another
// level.
constexpr double kAimed = 0.95;
// The sum's bounces are made of so many links per patch: their noise is then about what hybrid's aim is.
constexpr uint32_t kSumLinks = 64;

double strength(const glm::vec3& weight) {
    return std::max({weight.r, weight.g, weight.b});
}

// Tells whether the layer has direct light, made for where objects are.
bool isLit(const Layer& layer) {
    return layer.directSamplePasses > 0 && !layer.isOutdated();
}

// Tells whether the light is a sun or the sky, which light a whole level.
bool isDaylight(const Layer& layer) {
    const LightCacheKey& key = layer.cacheKey;
    return key.kind == LightKey::Kind::Sky ||
           (key.kind == LightKey::Kind::Lamp && key.light.type == LightType::Directional);
}

LayerLevel atLeast(LayerLevel a, LayerLevel b) {
    return {std::max(a.directSamplePasses, b.directSamplePasses),
            std::max(a.linkSamplePasses, b.linkSamplePasses)};
}

bool isBusy(const ScheduleState& state) {
    return !std::holds_alternative<ScheduleState::Nothing>(state.job);
}

} // namespace

LayerLevel LayerSchedule::lastLevel() const {
    const uint32_t samples = rules_.samples > 0 ? rules_.samples : kMaxSamplesOfPatch;
    const auto samplePasses = [&](uint32_t each) { return (samples + each - 1) / each; };
    return {samplePasses(rules_.pointsOfSamplePass),
            rules_.passes == 1 ? 0 : samplePasses(rules_.linksOfSamplePass)};
}

LayerLevel LayerSchedule::firstLevel() const {
    const LayerLevel last = lastLevel();
    return {std::min(2u, last.directSamplePasses), std::min(2u, last.linkSamplePasses)};
}

LayerLevel LayerSchedule::levelAfter(LayerLevel level) const {
    const LayerLevel last = lastLevel();
    const LayerLevel next = {level.directSamplePasses,
                             std::min(onLadder(level.linkSamplePasses + 1.0), last.linkSamplePasses)};
    return next == level ? last : next;
}

bool LayerSchedule::isHasty(LayerLevel target) const {
    return target == firstLevel() && target != lastLevel();
}

SampledPart LayerSchedule::directPart(const Layer& layer, double variance) const {
    return {.samplePasses = layer.level.directSamplePasses,
            .most = lastLevel().directSamplePasses,
            .variance = variance,
            .costOfSamplePass = std::max(1.0, layer.raysWeighed(rules_.costs.picked)) * layer.directShare(),
            .doubles = true,
            .fall = layer.plan.directFall};
}

// So many layers share what it costs to trace links.
SampledPart LayerSchedule::linkPart(const Layer& layer, double variance, size_t sharers) const {
    const double own = rules_.costs.gather, cost = own + (1.0 - own) / static_cast<double>(sharers);
    return {.samplePasses = layer.level.linkSamplePasses,
            .most = lastLevel().linkSamplePasses,
            .variance = variance,
            .costOfSamplePass = cost * rules_.linksOfSamplePass};
}

bool LayerSchedule::isGoodEnough(const Layer& layer) const {
    return rules_.layerError <= 0 || layer.error <= rules_.layerError;
}

// Returns the level by which the layer has the error that is asked for each.
LayerLevel LayerSchedule::levelByItself(const Layer& layer) const {
    const double error = rules_.layerError;
    const double sampled = layer.error * layer.error - layer.iterationError * layer.iterationError;
    const double iteration = std::min(layer.iterationError, kIterationShare * error); // of the next
    const double wanted = error * error - iteration * iteration;
    const double variance = layer.directVariance + layer.indirectVariance;
    const SamplePasses samplePasses =
        samplePassesFor(directPart(layer, layer.directVariance), linkPart(layer, layer.indirectVariance, 1),
                        sampled > 0.0 ? kAimed * variance * wanted / sampled : 0.0);
    return {samplePasses.first, samplePasses.second};
}

// Holds the layers that play a part, their numbers, and what they make together.
struct LayerSchedule::Standing {
    std::vector<Layer*> layers;
    std::vector<size_t> numbers; // among all
    Composite composite;
};

// Returns the levels by which all variances together come to this share of what they are, at the least cost:
// the composite's, or what of it makes the local error.
std::vector<LayerLevel> LayerSchedule::levelsFor(const Standing& standing, const CompositeLocal* local,
                                                 double share) const {
    const std::vector<Layer*>& layers = standing.layers;
    std::vector<SampledPart> parts;
    double sum = 0;
    for (size_t i = 0; i < layers.size(); ++i) {
        const CompositeLocal::Worth worth =
            local && !local->worths.empty() ? local->worths[standing.numbers[i]] : CompositeLocal::Worth();
        const Composite::Share& own = standing.composite.shares[i];
        parts.push_back(directPart(*layers[i], own.direct * worth.direct));
        parts.push_back(linkPart(*layers[i], own.indirect * worth.indirect, layers.size()));
        sum += own.direct * worth.direct + own.indirect * worth.indirect;
    }
    const std::vector<uint32_t> samplePasses = samplePassesFor(parts, kAimed * share * sum);
    std::vector<LayerLevel> levels;
    for (size_t i = 0; i < layers.size(); ++i)
        levels.push_back({samplePasses[2 * i], samplePasses[2 * i + 1]});
    return levels;
}

// Returns the levels by which the composite has its error and its local error at the least cost. Where it is
// later bounces that it lacks, the layer that lacks most goes on: the next level's bounces converge anew.
std::vector<LayerLevel> LayerSchedule::levelsTogether(const Standing& standing,
                                                      const CompositeLocal* local) const {
    const std::vector<Layer*>& layers = standing.layers;
    const Composite& composite = standing.composite;
    std::vector<LayerLevel> levels;
    for (const Layer* layer : layers)
        levels.push_back(layer->level);
    const std::vector<LayerLevel> before = levels;
    const auto raise = [&](const std::vector<LayerLevel>& wanted) {
        std::transform(levels.begin(), levels.end(), wanted.begin(), levels.begin(), atLeast);
    };
    const bool far = rules_.error > 0 && composite.error > rules_.error;
    const bool farLocally = rules_.localError > 0 && local && local->error > rules_.localError;
    if (!far && !farLocally) return levels;
    if (far) {
        const double iteration = std::min(composite.iteration, kIterationShare * rules_.error);
        const double sampled = composite.error * composite.error - composite.iteration * composite.iteration;
        if (sampled > 0)
            raise(levelsFor(standing, nullptr,
                            (rules_.error * rules_.error - iteration * iteration) / sampled));
    }
    if (farLocally) {
        const double ratio = rules_.localError / local->error;
        raise(levelsFor(standing, local, ratio * ratio));
    }
    if (levels != before) return levels;
    size_t worst = 0;
    for (size_t i = 1; i < layers.size(); ++i)
        if (composite.shares[i].error > composite.shares[worst].error) worst = i;
    const Layer& layer = *layers[worst];
    const SamplePasses doubled = samplePassesFor(directPart(layer, layer.directVariance),
                                                 linkPart(layer, layer.indirectVariance, layers.size()), 0.0);
    levels[worst] = {doubled.first, doubled.second};
    return levels;
}

// The composite decides on the levels of all layers at once, and anew when each has its own: then they depend
// neither on the order in which layers are made nor on who bounces along.
void LayerSchedule::apportion(const Layers& layers, bool weighedAnew, const CompositeLocal* local,
                              SketchProducts* products) const {
    bool underWay = false;
    Standing standing;
    std::vector<Layer*>& there = standing.layers;
    for (size_t i = 0; i < layers.size(); ++i) {
        const std::unique_ptr<Layer>& layer = layers[i];
        const bool goesOn = layer->has() && !layer->redo;
        const bool over = goesOn && isOver(*layer);
        if (weighedAnew || !goesOn || over || !layer->shines()) layer->plan.wanted = layer->level;
        layer->plan.wanted = atLeast(layer->plan.wanted, layer->level);
        if (goesOn && !over && takesAll()) layer->plan.wanted = lastLevel();
        layer->plan.converged = goesOn && layer->plan.wanted == layer->level;
        if (!layer->shines()) continue;
        underWay = underWay || !layer->plan.converged;
        if (!goesOn || layer->light <= 0) continue;
        there.push_back(layer.get());
        standing.numbers.push_back(i);
    }
    if (takesAll()) return;
    if (!underWay) {
        standing.composite = compositeOf(there, products);
        const std::vector<LayerLevel> together = levelsTogether(standing, local);
        for (size_t i = 0; i < there.size(); ++i) {
            // The composite may be as good as is asked for while dark places lack bounces.
            const bool hasty = there[i]->plan.hasty && together[i] == there[i]->level;
            there[i]->plan.wanted = hasty ? levelAfter(together[i]) : together[i];
        }
    }
    for (Layer* layer : there) {
        if (!isGoodEnough(*layer)) layer->plan.wanted = atLeast(layer->plan.wanted, levelByItself(*layer));
        layer->plan.converged = layer->plan.wanted == layer->level;
        // Direct light that was made ahead is part of whichever level comes next.
        if (!layer->plan.converged)
            layer->plan.wanted.directSamplePasses =
                std::max(layer->plan.wanted.directSamplePasses, layer->directSamplePasses);
    }
}

bool LayerSchedule::areTogether(const Layers& layers) const {
    return std::all_of(layers.begin(), layers.end(), [&](const std::unique_ptr<Layer>& layer) {
        return !layer->shines() ||
               (layer->has() && !layer->redo &&
                (isOver(*layer) || atLeast(layer->plan.wanted, layer->level) == layer->level));
    });
}

// Where the steps of a level that was there before begin with the first level, that is seen at once.
LayerLevel LayerSchedule::targetOf(const Layer& layer) const {
    if (!layer.redo) return layer.has() ? layer.plan.wanted : firstLevel();
    const uint32_t samplePasses = firstLevel().directSamplePasses;
    const bool first = !layer.has() && layer.directSamplePasses <= samplePasses && !layer.redoSteps.empty() &&
                       layer.redoSteps.front() == samplePasses;
    return first ? firstLevel() : *layer.redo;
}

LayerSchedule::Step LayerSchedule::next(const Layers& layers, const ScheduleState& state) const {
    if (state.relinkSamplePass && !sumComesFirst(layers, state)) return Relink{};
    if (isBusy(state)) return Continue{};
    if (state.sum.due) return BeginSum{};
    return nextLevelStep(layers, state);
}

LayerSchedule::Step LayerSchedule::nextLevelStep(const Layers& layers, const ScheduleState& state) const {
    const std::optional<size_t> dirty = dirtyLayer(layers);
    const std::optional<size_t> unlit =
        dirty && layers[*dirty]->isOutdated() ? std::nullopt : unlitLayer(layers, state);
    const auto begin = [&](size_t index, bool directAlone) {
        return BeginLayer{index, targetOf(*layers[index]), directAlone};
    };
    if (unlit) return begin(*unlit, true);
    if (dirty) return begin(*dirty, false);
    const std::optional<size_t> next = nextLayer(layers);
    if (!next) return Done{};
    const std::optional<size_t> direct = directFirst(layers, *next);
    return begin(direct.value_or(*next), direct.has_value());
}

bool LayerSchedule::takesEdits(const Layers& layers, const ScheduleState& state) const {
    if (state.sum.due || unlitLayer(layers, state)) return false;
    if (!isBusy(state)) return true;
    const auto* job = std::get_if<ScheduleState::LayerJob>(&state.job);
    return job && (state.sum.shown || job->hasLevel);
}

bool LayerSchedule::atRest(const Layers& layers, const ScheduleState& state) const {
    return takesEdits(layers, state) && !(rules_.live && state.unseen);
}

// Returns the layer to go on with. Those of which nothing is to be seen yet come first; of others the one
// whose error weighs most.
std::optional<size_t> LayerSchedule::nextLayer(const Layers& layers) const {
    std::optional<size_t> worst;
    double most = 0;
    for (size_t i = 0; i < layers.size(); ++i) {
        const Layer& layer = *layers[i];
        if (strength(layer.source.weight) <= 0) continue;
        if (!layer.has()) return i;
        if (layer.plan.converged) continue;
        const double weighed = strength(layer.source.weight) * layer.light * layer.error;
        if (worst && weighed <= most) continue;
        worst = i;
        most = weighed;
    }
    return worst;
}

std::vector<size_t> LayerSchedule::companions(const Layers& layers, size_t index, LayerLevel target) const {
    std::vector<size_t> others;
    for (size_t i = 0; rules_.together && i < layers.size(); ++i) {
        const Layer& layer = *layers[i];
        const bool waits = !layer.plan.converged && layer.dirty.empty() && layer.shines();
        if (i == index || !waits) continue;
        const LayerLevel own = targetOf(layer);
        if (own.linkSamplePasses == target.linkSamplePasses && isHasty(own) == isHasty(target))
            others.push_back(i);
    }
    return others;
}

// Returns one of the layers that can bounce together whose direct light is to be made before they do. A
// viewer is in haste for the first level of each.
std::optional<size_t> LayerSchedule::directFirst(const Layers& layers, size_t index) const {
    const LayerLevel target = targetOf(*layers[index]);
    if (target.linkSamplePasses == 0 || (rules_.live && !layers[index]->has())) return std::nullopt;
    std::vector<size_t> together = companions(layers, index, target);
    if (together.empty()) return std::nullopt;
    together.insert(together.begin(), index);
    together.resize(std::min<size_t>(together.size(), LayerBounces::kMostLanes));
    for (const size_t i : together)
        if (layers[i]->directSamplePasses < targetOf(*layers[i]).directSamplePasses) return i;
    return std::nullopt;
}

bool LayerSchedule::wantsSum(const Layers& layers, bool shown) const {
    if (!rules_.live || rules_.passes == 1) return false;
    size_t waiting = 0;
    bool deep = false;
    for (const std::unique_ptr<Layer>& layer : layers) {
        if (!layer->shines() || layer->has()) continue;
        ++waiting;
        deep = deep || (layer->redo && layer->redo->linkSamplePasses > sumSamplePasses());
    }
    return waiting > 1 || (waiting == 1 && (deep || shown));
}

bool LayerSchedule::canSum(const Layers& layers, bool shown) const {
    return wantsSum(layers, shown) &&
           ((!shown && canBeginWithDaylight(layers)) ||
            std::all_of(layers.begin(), layers.end(), [](const std::unique_ptr<Layer>& layer) {
                return !layer->shines() || isLit(*layer);
            }));
}

bool LayerSchedule::canBeginWithDaylight(const Layers& layers) {
    bool lit = false;
    for (const std::unique_ptr<Layer>& layer : layers) {
        if (layer->shown() != nullptr || layer->covered) return false;
        if (!layer->shines() || !isDaylight(*layer)) continue;
        if (!isLit(*layer)) return false;
        lit = true;
    }
    return lit;
}

uint32_t LayerSchedule::sumSamplePasses() const {
    return std::max(1u, kSumLinks / rules_.linksOfSamplePass);
}

uint32_t LayerSchedule::sumSamplePasses(const Layers& layers) const {
    uint32_t samplePasses = 1;
    for (const std::unique_ptr<Layer>& layer : layers) {
        if (!layer->shines()) continue;
        const LayerLevel level = layer->has() ? layer->level : layer->redo.value_or(LayerLevel());
        samplePasses = std::max(samplePasses, level.linkSamplePasses);
    }
    return std::min(samplePasses, sumSamplePasses());
}

// Returns a layer whose direct light is to be made before any layer goes on, so that it is seen among all
// lights; daylight comes first.
std::optional<size_t> LayerSchedule::unlitLayer(const Layers& layers, const ScheduleState& state) const {
    if (!state.sum.shown && !(state.unseen && wantsSum(layers, state.sum.shown))) return std::nullopt;
    std::optional<size_t> unlit;
    for (size_t i = 0; i < layers.size(); ++i) {
        if (!layers[i]->shines() || layers[i]->directSamplePasses > 0) continue;
        if (isDaylight(*layers[i])) return i;
        if (!unlit) unlit = i;
    }
    return unlit;
}

std::optional<size_t> LayerSchedule::dirtyLayer(const Layers& layers) const {
    std::optional<size_t> dirty;
    for (size_t i = 0; rules_.live && i < layers.size(); ++i) {
        const Layer& layer = *layers[i];
        if (!layer.shines() || layer.dirty.empty()) continue;
        if (layer.isOutdated()) return i;
        if (!dirty) dirty = i;
    }
    return dirty;
}

// Tells whether the links of later sample passes wait before they follow objects that moved: direct light
// comes first, and all is seen in one.
bool LayerSchedule::sumComesFirst(const Layers& layers, const ScheduleState& state) const {
    return rules_.live && *state.relinkSamplePass >= sumSamplePasses() &&
           (isBusy(state) || state.sum.due || dirtyLayer(layers) || unlitLayer(layers, state));
}

bool LayerSchedule::isWhole(const Layers& layers, const ScheduleState& state) const {
    if (state.sum.due || std::holds_alternative<ScheduleState::SumJob>(state.job)) return false;
    return std::all_of(layers.begin(), layers.end(), [&](const std::unique_ptr<Layer>& layer) {
        return !layer->shines() || (state.sum.shown ? isLit(*layer) : layer->has());
    });
}

LayerSchedule::Told LayerSchedule::told(const Layers& layers, std::optional<double> localError,
                                        SketchProducts* products) const {
    std::vector<Layer*> shining;
    bool all = true, enough = true;
    for (const std::unique_ptr<Layer>& layer : layers) {
        if (strength(layer->source.weight) <= 0) continue;
        shining.push_back(layer.get());
        all = all && layer->has();
        enough = enough && !layer->redo && (layer->light <= 0 || isGoodEnough(*layer)) &&
                 (!takesAll() || layer->plan.converged);
    }
    Told told;
    told.error = all ? compositeOf(shining, products).error : 1.0;
    told.converged = all && enough && (rules_.error <= 0 || told.error <= rules_.error) &&
                     (rules_.localError <= 0 || (localError && *localError <= rules_.localError));
    return told;
}

} // namespace relume
