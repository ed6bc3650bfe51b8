#include "bake/layers/layer_schedule.h"

#include "bake/base/settling.h"
#include "bake/gather/sample_plan.h"
#include "bake/layers/layer_bounces.h"

#include <algorithm>

namespace relume {
namespace {

// A segment towards a light counts as so many links. Links are traced once for all layers, and what a layer
// pays for itself is to gather them, so with many lights they cost far less than a segment; but those beyond
// the memory are traced for each.
constexpr double kSegmentLinks = 1.0;
// A level aims at this share of the variance that is allowed: a little too much costs bounces of another
// level.
constexpr double kAimed = 0.85;
// The sum's bounces are made of so many links per patch: their noise is then about what hybrid's aim is.
constexpr uint32_t kSumLinks = 64;

double strength(const glm::vec3& weight) {
    return std::max({weight.r, weight.g, weight.b});
}

// Tells whether the layer has direct light, made for where objects are.
bool isLit(const Layer& layer) {
    return layer.directRounds > 0 && !layer.isOutdated();
}

bool isBusy(const ScheduleState& state) {
    return !std::holds_alternative<ScheduleState::Nothing>(state.job);
}

} // namespace

LayerLevel LayerSchedule::lastLevel() const {
    const uint32_t samples = rules_.samples > 0 ? rules_.samples : kMaxSamplesOfPatch;
    const auto rounds = [&](uint32_t each) { return (samples + each - 1) / each; };
    return {rounds(rules_.pointsOfRound), rules_.passes == 1 ? 0 : rounds(rules_.linksOfRound)};
}

LayerLevel LayerSchedule::firstLevel() const {
    const LayerLevel last = lastLevel();
    return {std::min(2u, last.directRounds), std::min(2u, last.linkRounds)};
}

bool LayerSchedule::isHasty(LayerLevel target) const {
    return target == firstLevel() && target != lastLevel();
}

// Returns the next level, whether or not links are there already: it must not depend on what was done before.
LayerLevel LayerSchedule::nextLevel(const Layer& layer) const {
    const LayerLevel now = layer.level, last = lastLevel();
    if (rules_.error <= 0) return last;
    const double sampled = layer.error * layer.error - layer.iterationError * layer.iterationError;
    const double iteration = std::min(layer.iterationError, kIterationShare * rules_.error); // of the next
    const double wanted = rules_.error * rules_.error - iteration * iteration;
    const double variance = layer.directVariance + layer.indirectVariance;
    const Rounds rounds =
        roundsFor({.rounds = now.directRounds,
                   .most = last.directRounds,
                   .variance = layer.directVariance,
                   .costOfRound = kSegmentLinks * std::max(1u, layer.rays()) * layer.directShare()},
                  {.rounds = now.linkRounds,
                   .most = last.linkRounds,
                   .variance = layer.indirectVariance,
                   .costOfRound = static_cast<double>(rules_.linksOfRound)},
                  sampled > 0.0 ? kAimed * variance * wanted / sampled : 0.0);
    return {rounds.first, rounds.second};
}

// Where the steps of a level that was there before begin with the first level, that is seen at once.
LayerLevel LayerSchedule::targetOf(const Layer& layer) const {
    if (!layer.redo) return layer.has() ? nextLevel(layer) : firstLevel();
    const uint32_t rounds = firstLevel().directRounds;
    const bool first = !layer.has() && layer.directRounds <= rounds && !layer.redoSteps.empty() &&
                       layer.redoSteps.front() == rounds;
    return first ? firstLevel() : *layer.redo;
}

bool LayerSchedule::isConverged(const Layer& layer) const {
    return !layer.redo && (layer.level == lastLevel() || (rules_.error > 0 && layer.error <= rules_.error) ||
                           layer.light <= 0);
}

LayerSchedule::Step LayerSchedule::next(const Layers& layers, const ScheduleState& state) const {
    if (state.relinkRound && !sumComesFirst(layers, state)) return Relink{};
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
        if (layer.converged) continue;
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
        const bool waits = !layer.converged && layer.stale.empty() && layer.shines();
        if (i == index || !waits) continue;
        const LayerLevel own = targetOf(layer);
        if (own.linkRounds == target.linkRounds && isHasty(own) == isHasty(target)) others.push_back(i);
    }
    return others;
}

// Returns one of the layers that can bounce together whose direct light is to be made before they do. A
// viewer is in haste for the first level of each.
std::optional<size_t> LayerSchedule::directFirst(const Layers& layers, size_t index) const {
    const LayerLevel target = targetOf(*layers[index]);
    if (target.linkRounds == 0 || (rules_.live && !layers[index]->has())) return std::nullopt;
    std::vector<size_t> together = companions(layers, index, target);
    if (together.empty()) return std::nullopt;
    together.insert(together.begin(), index);
    together.resize(std::min<size_t>(together.size(), LayerBounces::kMostLanes));
    for (const size_t i : together)
        if (layers[i]->directRounds < targetOf(*layers[i]).directRounds) return i;
    return std::nullopt;
}

bool LayerSchedule::wantsSum(const Layers& layers, bool shown) const {
    if (!rules_.live || rules_.passes == 1) return false;
    size_t waiting = 0;
    bool deep = false;
    for (const std::unique_ptr<Layer>& layer : layers) {
        if (!layer->shines() || layer->has()) continue;
        ++waiting;
        deep = deep || (layer->redo && layer->redo->linkRounds > sumRounds());
    }
    return waiting > 1 || (waiting == 1 && (deep || shown));
}

bool LayerSchedule::canSum(const Layers& layers, bool shown) const {
    return wantsSum(layers, shown) &&
           std::all_of(layers.begin(), layers.end(),
                       [](const std::unique_ptr<Layer>& layer) { return !layer->shines() || isLit(*layer); });
}

uint32_t LayerSchedule::sumRounds() const {
    return std::max(1u, kSumLinks / rules_.linksOfRound);
}

uint32_t LayerSchedule::sumRounds(const Layers& layers) const {
    uint32_t rounds = 1;
    for (const std::unique_ptr<Layer>& layer : layers) {
        if (!layer->shines()) continue;
        const LayerLevel level = layer->has() ? layer->level : layer->redo.value_or(LayerLevel());
        rounds = std::max(rounds, level.linkRounds);
    }
    return std::min(rounds, sumRounds());
}

// Returns a layer whose direct light is to be made before any layer goes on, so that it is seen among all
// lights.
std::optional<size_t> LayerSchedule::unlitLayer(const Layers& layers, const ScheduleState& state) const {
    const bool summed = state.sum.shown || (state.unseen && wantsSum(layers, state.sum.shown));
    for (size_t i = 0; summed && i < layers.size(); ++i)
        if (layers[i]->shines() && layers[i]->directRounds == 0) return i;
    return std::nullopt;
}

std::optional<size_t> LayerSchedule::dirtyLayer(const Layers& layers) const {
    std::optional<size_t> dirty;
    for (size_t i = 0; rules_.live && i < layers.size(); ++i) {
        const Layer& layer = *layers[i];
        if (!layer.shines() || layer.stale.empty()) continue;
        if (layer.isOutdated()) return i;
        if (!dirty) dirty = i;
    }
    return dirty;
}

// Tells whether the links of later sample passes wait before they follow objects that moved: direct light
// comes first, and all is seen in one.
bool LayerSchedule::sumComesFirst(const Layers& layers, const ScheduleState& state) const {
    return rules_.live && *state.relinkRound >= sumRounds() &&
           (isBusy(state) || state.sum.due || dirtyLayer(layers) || unlitLayer(layers, state));
}

bool LayerSchedule::isWhole(const Layers& layers, const ScheduleState& state) const {
    if (state.sum.due || std::holds_alternative<ScheduleState::SumJob>(state.job)) return false;
    return std::all_of(layers.begin(), layers.end(), [&](const std::unique_ptr<Layer>& layer) {
        return !layer->shines() || (state.sum.shown ? isLit(*layer) : layer->has());
    });
}

LayerSchedule::Told LayerSchedule::told(const Layers& layers) const {
    double light = 0, error = 0;
    bool all = true, converged = true;
    for (const std::unique_ptr<Layer>& layer : layers) {
        const double weight = strength(layer->source.weight);
        if (weight <= 0) continue;
        all = all && layer->has();
        converged = converged && layer->converged;
        light += weight * layer->light;
        error += weight * layer->light * layer->error;
    }
    Told told;
    told.error = !all ? 1.0 : light > 0 ? error / light : 0.0;
    told.converged = all && converged && (rules_.error <= 0 || told.error <= rules_.error);
    return told;
}

} // namespace relume
