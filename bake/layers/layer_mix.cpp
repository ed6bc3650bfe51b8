// This part of LayerSolver makes the sum of the layers, and what else can be looked at.
#include "bake/layers/layer_solver.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace relume {

void LayerSolver::changed(size_t layer) {
    stale_ = true;
    light_.clear();
    if (sumShown_) return;
    if (std::find(changed_.begin(), changed_.end(), layer) == changed_.end()) changed_.push_back(layer);
}

void LayerSolver::allChanged() {
    stale_ = true;
    light_.clear();
    restOf_.reset();
    changed_.clear();
    allChanged_ = true;
}

std::vector<shader::LayerWeight> LayerSolver::shares(std::optional<size_t> without,
                                                     std::optional<size_t> only) const {
    std::vector<shader::LayerWeight> list;
    for (size_t i = 0; i < layers_.size(); ++i) {
        const Layer* shown = layers_[i]->shown();
        if (i == without || (only && i != only) || !shown || layers_[i]->covered ||
            layers_[i]->source.weight == glm::vec3(0.0f))
            continue;
        list.push_back({.light = shown->result.address(), .weight = layers_[i]->source.weight});
    }
    if (standIn_ && !only) list.push_back({.light = standIn_.address(), .weight = glm::vec3(1.0f)});
    return list;
}

// Writes the weights and returns how many there are.
uint32_t LayerSolver::writeWeights(const std::vector<shader::LayerWeight>& list) {
    const uint64_t bytes = std::max<uint64_t>(1, list.size()) * sizeof(shader::LayerWeight);
    if (!weights_ || weights_.size() < bytes)
        weights_ = vk::Buffer(input_.device, {.size = bytes, .memory = vk::Memory::Host, .name = "weights"});
    std::memcpy(weights_.mapped(), list.data(), list.size() * sizeof(shader::LayerWeight));
    return static_cast<uint32_t>(list.size());
}

// Mixes in the layers' order: the bytes are the same whatever was shown before.
void LayerSolver::mix(const vk::Buffer& to) {
    VkCommandBuffer cmd = commands_.begin();
    if (sumShown_) {
        const VkBufferCopy all{0, 0, to.size()};
        vkCmdCopyBuffer(cmd, sum_->result.handle(), to.handle(), 1, &all);
    } else {
        const uint32_t count = writeWeights(shares(std::nullopt, std::nullopt));
        layerPass_.recordMix(cmd, weights_, count, nullptr, to);
    }
    run(cmd);
}

// Mixes for a viewer. While one layer changes again and again the sum of the others is kept: an edit then
// costs two layers.
void LayerSolver::mixForViewer() {
    if (std::exchange(allChanged_, false) || sumShown_ || changed_.size() != 1) {
        mix(composite_);
        restOf_.reset();
        changed_.clear();
        return;
    }
    const size_t layer = changed_.front();
    if (restOf_ != layer) {
        if (!rest_) rest_ = vk::Buffer(input_.device, {.size = composite_.size(), .name = "other layers"});
        const uint32_t count = writeWeights(shares(layer, std::nullopt));
        VkCommandBuffer cmd = commands_.begin();
        layerPass_.recordMix(cmd, weights_, count, nullptr, rest_);
        vk::barrier(cmd);
        commands_.run();
        restOf_ = layer;
    }
    const uint32_t count = writeWeights(shares(std::nullopt, layer));
    VkCommandBuffer cmd = commands_.begin();
    layerPass_.recordMix(cmd, weights_, count, &rest_, composite_);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    changed_.clear();
}

LiveLight LayerSolver::liveLight() {
    ASSERT(settings_.live);
    std::vector<ChunkRange> ranges;
    if (allChanged_ || !changed_.empty()) {
        mixForViewer();
        ranges = {{0, input_.patches.chunkCount()}};
        ++version_;
    }
    const bool complete =
        sumShown_ || std::all_of(layers_.begin(), layers_.end(), [](const std::unique_ptr<Layer>& layer) {
            return layer->shown() != nullptr || layer->covered || layer->source.weight == glm::vec3(0.0f);
        });
    return {&composite_, version_, complete, std::move(ranges)};
}

const std::vector<glm::vec4>& LayerSolver::light() {
    if (stale_ || light_.empty()) {
        mix(composite_);
        restOf_.reset();
        light_ = vk::readBuffer<glm::vec4>(input_.device, composite_, input_.patches.scene.patches.size());
        stale_ = false;
    }
    return light_;
}

std::vector<float> LayerSolver::errors() {
    std::vector<float> result;
    for (const glm::vec4& v : light())
        result.push_back(v.w);
    return result;
}

std::vector<glm::vec4> LayerSolver::layerLight(const Layer& layer) const {
    if (!layer.has()) return std::vector<glm::vec4>(input_.patches.scene.patches.size(), glm::vec4(0.0f));
    return vk::readBuffer<glm::vec4>(input_.device, layer.result, input_.patches.scene.patches.size());
}

namespace {

// The part of a layer's state that its buffers do not hold.
struct LayerState {
    uint32_t directRounds = 0;
    LayerLevel level;
    SmoothingWidth width;
    double light = 0, count = 0, directVariance = 0, indirectVariance = 0, iterationError = 1, error = 1;
    bool converged = false;
};

} // namespace

// A level under way is begun anew after a restore: it is a pure function of what it began with.
SolverState LayerSolver::state() {
    ASSERT(!done_);
    SolverState state{progress_, progress_.passSeconds, {}};
    for (const std::unique_ptr<Layer>& layer : layers_) {
        LayerState own;
        std::memset(static_cast<void*>(&own), 0, sizeof own); // padding, too
        own.directRounds = layer->directRounds;
        own.level = layer->level;
        own.width = layer->width;
        own.light = layer->light;
        own.count = layer->count;
        own.directVariance = layer->directVariance;
        own.indirectVariance = layer->indirectVariance;
        own.iterationError = layer->iterationError;
        own.error = layer->error;
        own.converged = layer->converged;
        const auto* bytes = reinterpret_cast<const uint8_t*>(&own);
        state.own.insert(state.own.end(), bytes, bytes + sizeof own);
        layer->penumbra.resize(parts_.count, 0);
        state.own.insert(state.own.end(), layer->penumbra.begin(), layer->penumbra.end());
    }
    return state;
}

std::vector<StatePart> LayerSolver::stateParts() {
    std::vector<StatePart> parts;
    for (const std::unique_ptr<Layer>& layer : layers_) {
        if (!layer->direct)
            layer->direct = std::make_shared<vk::Buffer>(takeBuffer("direct light of a layer"));
        if (!layer->result) layer->result = takeBuffer("layer");
        parts.push_back(part(input_.device, *layer->direct));
        parts.push_back(part(input_.device, layer->result));
    }
    return parts;
}

void LayerSolver::restore(const SolverState& state) {
    const size_t each = sizeof(LayerState) + parts_.count;
    if (state.own.size() != layers_.size() * each)
        throw Error("this state is not of such a solver: bake from the start");
    abortPass();
    const SolverCounters own = progress_;
    static_cast<SolverCounters&>(progress_) = state.counters;
    progress_.passSeconds = state.passSeconds;
    progress_.cacheBytes = own.cacheBytes;
    for (size_t i = 0; i < layers_.size(); ++i) {
        LayerState from;
        const uint8_t* bytes = state.own.data() + i * each;
        std::memcpy(&from, bytes, sizeof from);
        Layer& layer = *layers_[i];
        layer.penumbra.assign(bytes + sizeof from, bytes + each);
        layer.directRounds = from.directRounds;
        layer.directSteps.assign(1, from.directRounds);
        layer.level = from.level;
        layer.width = from.width;
        layer.light = from.light;
        layer.count = from.count;
        layer.directVariance = from.directVariance;
        layer.indirectVariance = from.indirectVariance;
        layer.iterationError = from.iterationError;
        layer.error = from.error;
        layer.converged = from.converged;
        changed(i);
    }
    done_ = false;
    distancesKnown_ = false;
}

} // namespace relume
