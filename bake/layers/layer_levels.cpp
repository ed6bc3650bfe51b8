// This part of LayerSolver decides which layer comes next and how far it is taken, and keeps what is known of
// its error.
#include "bake/gather/host_resolve.h"
#include "bake/layers/layer_solver.h"

#include "bake/base/finite_light.h"
#include "bake/layers/level_growth.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace relume {
namespace {

// A segment towards a light counts as so many links. Links are traced once for all layers, and what a layer
// pays for itself is to gather them, so with many lights they cost far less than a segment; but those beyond
// the memory are traced for each.
constexpr double kSegmentLinks = 1.0;
// A level aims at this share of the variance that is allowed: a little too much costs bounces of another
// level.
constexpr double kAimed = 0.85;
// The first level is smoothed by this [texels]: its few links are noisy, and there is no time to try more.
constexpr double kFirstSigma = 3.0;
// Beyond so many directions or points per patch no error is worth the time.
constexpr uint32_t kMaxSamples = 65536;

// These are floats per chunk.
constexpr uint32_t kResolveValues = sizeof(shader::ResolveSums) / sizeof(float);
constexpr uint32_t kResultValues = sizeof(glm::vec4) / sizeof(float);

// Returns the width that is likely best [texels]: noise falls as samples come in, so that the best width
// falls, too, as in the Cornell rooms and an atrium, where it is 2 to 4 with 50 directions per patch and .5
// to .7 with 2000. settle() finds what it is.
double likelyWidth(uint32_t samples) {
    constexpr double kLeast = 0.5;
    return std::max(kLeast, kFirstSigma * std::pow(32.0 / std::max(samples, 32u), 0.4));
}

double strength(const glm::vec3& weight) {
    return std::max({weight.r, weight.g, weight.b});
}

} // namespace

LayerLevel LayerSolver::lastLevel() const {
    const uint32_t samples = settings_.links.samples > 0 ? settings_.links.samples : kMaxSamples;
    const auto rounds = [&](uint32_t each) { return (samples + each - 1) / each; };
    return {rounds(kPointsOfRound), settings_.passes == 1 ? 0 : rounds(linksOfRound_)};
}

// Returns what a light that is moved shows at once: another sample pass of direct light goes to its penumbra.
LayerLevel LayerSolver::firstLevel() const {
    const LayerLevel last = lastLevel();
    return {std::min(2u, last.directRounds), std::min(2u, last.linkRounds)};
}

// Tells whether this is the first level and others follow.
bool LayerSolver::isHasty(LayerLevel target) const {
    return target == firstLevel() && target != lastLevel();
}

// Returns the next level, whether or not links are there already: it must not depend on what was done before.
LayerLevel LayerSolver::nextLevel(const Layer& layer) const {
    const LayerLevel now = layer.level, last = lastLevel();
    if (settings_.error <= 0) return last;
    const double sampled = layer.error * layer.error - layer.iterationError * layer.iterationError;
    const double iteration = std::min(layer.iterationError, kIterationShare * settings_.error); // of the next
    const double wanted = settings_.error * settings_.error - iteration * iteration;
    const double variance = layer.directVariance + layer.indirectVariance;
    const Rounds rounds =
        roundsFor({.rounds = now.directRounds,
                   .most = last.directRounds,
                   .variance = layer.directVariance,
                   .costOfRound = kSegmentLinks * std::max(1u, raysOf(layer)) * layer.directShare()},
                  {.rounds = now.linkRounds,
                   .most = last.linkRounds,
                   .variance = layer.indirectVariance,
                   .costOfRound = static_cast<double>(linksOfRound_)},
                  sampled > 0.0 ? kAimed * variance * wanted / sampled : 0.0);
    return {rounds.first, rounds.second};
}

// Returns the level to be made now. One that was there before is made in the steps that it was made in. Where
// these begin with the first level, that is seen at once.
LayerLevel LayerSolver::targetOf(const Layer& layer) const {
    if (!layer.redo) return layer.has() ? nextLevel(layer) : firstLevel();
    const uint32_t rounds = firstLevel().directRounds;
    const bool first = !layer.has() && layer.directRounds <= rounds && !layer.redoSteps.empty() &&
                       layer.redoSteps.front() == rounds;
    return first ? firstLevel() : *layer.redo;
}

// Returns the layer to go on with. Those of which nothing is to be seen yet come first; of others the one
// whose error weighs most.
std::optional<size_t> LayerSolver::nextLayer() const {
    std::optional<size_t> worst;
    double most = 0;
    for (size_t i = 0; i < layers_.size(); ++i) {
        const Layer& layer = *layers_[i];
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

// Reads back what is summed over chunks: the sums of all of them or, where the device gathers, their sum.
void LayerSolver::recordChunkSums(VkCommandBuffer cmd, uint32_t width, VkDeviceSize at) {
    const uint32_t chunks = input_.patches.chunkCount();
    const VkDeviceSize bytes = width * sizeof(float);
    if (!bounces_) return recordBack(cmd, buffers_.chunkSums, chunks * bytes, at);
    vk::barrier(cmd);
    chunkSums_.record(cmd, {.values = buffers_.chunkSums.address(),
                            .sums = buffers_.sums.address(),
                            .chunkCount = chunks,
                            .width = width});
    recordBack(cmd, buffers_.sums, bytes, at);
}

// Makes the layer's result of its sums over links; with no sample passes of links, of direct light alone.
LayerSolver::LevelSums LayerSolver::resolve(const Layer& layer, uint32_t linkRounds, double sigma) {
    if (gatherPass_.onCpu()) return resolveOnCpu(layer, linkRounds, sigma);
    const uint32_t chunks = input_.patches.chunkCount(), sums = bounces_ ? 1 : chunks;
    const VkDeviceSize behind = sums * sizeof(shader::ResolveSums);
    VkCommandBuffer cmd = commands_.begin();
    if (linkRounds > 0) {
        resolvePass_.record(cmd, input_.light, buffers_,
                            {.size = input_.patches.scene.size,
                             .samples = linkRounds * linksOfRound_,
                             .sigma = static_cast<float>(sigma)});
        recordChunkSums(cmd, kResolveValues, 0);
        vk::barrier(cmd);
    }
    layerPass_.recordResult(cmd, input_.light, layer, linkRounds > 0 ? &buffers_.result : nullptr,
                            buffers_.chunkSums);
    recordChunkSums(cmd, kResultValues, behind);
    run(cmd);
    LevelSums level;
    if (linkRounds > 0) level.indirect = sumsOf(std::span(back_.as<shader::ResolveSums>(), sums));
    const auto* result = reinterpret_cast<const glm::vec4*>(back_.as<uint8_t>() + behind);
    level.result = sumsOf(std::span(result, sums));
    return level;
}

LayerSolver::LevelSums LayerSolver::resolveOnCpu(const Layer& layer, uint32_t linkRounds,
                                                 double sigma) const {
    const uint32_t samples = linkRounds * linksOfRound_;
    const auto width = static_cast<float>(sigma);
    const bool smooths = linkRounds > 0 && buffers_.rows;
    const HostResolveSums sums =
        resolveLayer(gatherPass_.pool(), {.patches = input_.light.patches.as<shader::Patch>(),
                                          .patchChart = buffers_.patchChart.as<uint32_t>(),
                                          .texelToPatch = buffers_.texelToPatch.as<uint32_t>(),
                                          .distances = smooths ? buffers_.distances.as<float>() : nullptr,
                                          .sums = buffers_.linkSums.as<glm::vec4>(),
                                          .rows = smooths ? buffers_.rows.as<glm::vec4>() : nullptr,
                                          .direct = layer.direct->as<glm::vec4>(),
                                          .result = layer.result.as<glm::vec4>(),
                                          .size = input_.patches.scene.size,
                                          .chunkCount = input_.patches.chunkCount(),
                                          .reach = smooths ? smoothingReach(width) : 0,
                                          .sigma = width,
                                          .scale = samples > 0 ? static_cast<float>(shader::kReplicates) /
                                                                     static_cast<float>(samples)
                                                               : 0.0f});
    return {sumsOf(sums.indirect), sumsOf(sums.result)};
}

void LayerSolver::finishLevel(const Lane& lane) {
    const Work& work = *work_;
    Layer& layer = layerOf(lane);
    const auto index = static_cast<uint32_t>(&lane - work.lanes.data());
    if (index > 0) std::swap(buffers_.linkSums, bounces_->sums(index));
    if (!layer.result) layer.result = takeBuffer("layer");
    LevelSums sums;
    layer.width = {.sigma = likelyWidth(lane.target.linkRounds * linksOfRound_)};
    const auto at = [&](double sigma) {
        sums = resolve(layer, lane.target.linkRounds, sigma);
        return sums.indirect;
    };
    const bool smooths = lane.target.linkRounds > 0 && buffers_.rows;
    distancesKnown_ = distancesKnown_ || lane.target.linkRounds > 0;
    if (smooths && !(lane.target == firstLevel()))
        layer.width.settle(at);
    else
        at(smooths ? kFirstSigma : 0.0);
    if (index > 0) std::swap(buffers_.linkSums, bounces_->sums(index));
    const glm::dvec4 total = sums.result;
    requireFiniteLight(total.x, total.y + sums.indirect.indirect + sums.indirect.raw);
    layer.level = lane.target;
    layer.light = total.x;
    layer.count = total.z;
    layer.directVariance = total.y;
    layer.indirectVariance = smoothedVariance(sums.indirect);
    // The light that bounces have converged to is gathered once more; of several gathers the last one is what
    // was measured.
    const double more = work.gathers > 1 ? 1.0 : lane.ratio;
    layer.iterationError = settings_.passes > 0 ? 0.0 : lane.iterationError * more;
    layer.error = 0;
    if (layer.light > 0) {
        const double mean = layer.light / (3.0 * layer.count);
        const double variance = (layer.directVariance + layer.indirectVariance) / (3.0 * layer.count);
        layer.error = std::sqrt(variance / (mean * mean) + layer.iterationError * layer.iterationError);
    }
    if (layer.redo == layer.level) {
        layer.redo.reset();
        layer.redoSteps.clear();
    }
    layer.converged =
        !layer.redo && (layer.level == lastLevel() ||
                        (settings_.error > 0 && layer.error <= settings_.error) || layer.light <= 0);
    // The counters take the level's own work, whoever bounced along and whatever was begun in vain: it is the
    // light's own history.
    progress_.passes += lane.looked + work.gathers;
    progress_.pairs += lane.gathered;
    progress_.cacheBytes = links_.bytes();
    if (work.sum) return showSum();
    if (layer.before) archive(std::move(layer.before));
    progress_.samples = std::max(progress_.samples, layer.level.linkRounds * linksOfRound_);
    changed(lane.layer);
    endStandIn();
    if (sumShown_ && !wantsSum()) hideSum();
    tellError();
}

// Layers share links, so that their errors may have one sign: they are added up.
void LayerSolver::tellError() {
    double light = 0, error = 0;
    bool all = true, converged = true;
    for (const std::unique_ptr<Layer>& layer : layers_) {
        const double weight = strength(layer->source.weight);
        if (weight <= 0) continue;
        all = all && layer->has();
        converged = converged && layer->converged;
        light += weight * layer->light;
        error += weight * layer->light * layer->error;
    }
    progress_.error = !all ? 1.0 : light > 0 ? error / light : 0.0;
    progress_.converged = all && converged && (settings_.error <= 0 || progress_.error <= settings_.error);
}

} // namespace relume
