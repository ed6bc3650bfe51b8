#include "bake/layers/layer_mixer.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

bool addsDirect(const std::unique_ptr<Layer>& layer) {
    return layer->shines() && layer->direct && layer->directSamplePasses > 0 && layer->rays() > 0;
}

} // namespace

LayerMixer::LayerMixer(LinkKit& kit, const LayerPass& pass)
    : kit_(kit), pass_(pass), composite_(kit.input.device, {.size = kit.lightBytes(), .name = "composite"}) {}

void LayerMixer::changed(size_t layer) {
    stale_ = true;
    light_.clear();
    if (sum_) return;
    if (std::find(changed_.begin(), changed_.end(), layer) == changed_.end()) changed_.push_back(layer);
}

void LayerMixer::eachChanged(size_t layers) {
    for (size_t i = 0; i < layers; ++i)
        changed(i);
}

void LayerMixer::replaced() {
    stale_ = true;
    light_.clear();
    restOf_.reset();
    changed_.clear();
    allChanged_ = true;
}

void LayerMixer::showSum(const vk::Buffer& sum, size_t layers, bool whole) {
    sum_ = nullptr; // what is shown changes
    eachChanged(layers);
    sum_ = &sum;
    sumWhole_ = whole;
}

void LayerMixer::hideSum(size_t layers) {
    if (!std::exchange(sum_, nullptr)) return;
    restOf_.reset();
    eachChanged(layers);
}

void LayerMixer::beginStandIn(const std::vector<const Layer*>& former, vk::Buffer to) {
    Weights list;
    for (const Layer* layer : former)
        list.push_back({.light = layer->shown()->result.address(), .weight = layer->source.weight});
    if (standIn_) list.push_back({.light = standIn_.address(), .weight = glm::vec3(1.0f)});
    run(list, nullptr, to);
    standIn_ = std::move(to);
}

void LayerMixer::beginStandIn(const std::vector<glm::vec4>& light, vk::Buffer to) {
    for (const vk::Buffer* buffer : {&to, &composite_})
        vk::upload(kit_.input.device, *buffer, light.data(), light.size() * sizeof(light[0]));
    standIn_ = std::move(to);
}

void LayerMixer::endStandIn(size_t layers) {
    standIn_ = vk::Buffer();
    restOf_.reset();
    eachChanged(layers);
}

LayerMixer::Weights LayerMixer::shares(const Layers& layers, std::optional<size_t> without,
                                       std::optional<size_t> only) const {
    Weights list;
    for (size_t i = 0; i < layers.size(); ++i) {
        const Layer* shown = layers[i]->shown();
        if (i == without || (only && i != only) || !shown || layers[i]->covered || !layers[i]->shines())
            continue;
        list.push_back({.light = shown->result.address(), .weight = layers[i]->source.weight});
    }
    if (standIn_ && !only) list.push_back({.light = standIn_.address(), .weight = glm::vec3(1.0f)});
    return list;
}

// Writes the weights and returns how many there are.
uint32_t LayerMixer::writeWeights(const Weights& list) {
    const uint64_t bytes = std::max<uint64_t>(1, list.size()) * sizeof(shader::LayerWeight);
    if (!weights_ || weights_.size() < bytes)
        weights_ =
            vk::Buffer(kit_.input.device, {.size = bytes, .memory = vk::Memory::Host, .name = "weights"});
    std::copy(list.begin(), list.end(), weights_.as<shader::LayerWeight>());
    return static_cast<uint32_t>(list.size());
}

void LayerMixer::run(const Weights& list, const vk::Buffer* base, const vk::Buffer& to) {
    const uint32_t count = writeWeights(list);
    VkCommandBuffer cmd = kit_.commands.begin();
    pass_.recordMix(cmd, weights_, count, base, to);
    kit_.run(cmd);
}

void LayerMixer::mixDirect(const Layers& layers, const vk::Buffer& direct) {
    Weights list;
    for (const std::unique_ptr<Layer>& layer : layers)
        if (addsDirect(layer))
            list.push_back({.light = layer->direct->address(), .weight = layer->source.weight});
    const uint32_t count = writeWeights(list);
    VkCommandBuffer cmd = kit_.commands.begin();
    pass_.recordMixDirect(cmd, weights_, count, direct);
    kit_.run(cmd);
}

void LayerMixer::mix(const Layers& layers) {
    restOf_.reset();
    if (!sum_) return run(shares(layers, std::nullopt, std::nullopt), nullptr, composite_);
    VkCommandBuffer cmd = kit_.commands.begin();
    const VkBufferCopy all{0, 0, composite_.size()};
    vkCmdCopyBuffer(cmd, sum_->handle(), composite_.handle(), 1, &all);
    kit_.run(cmd);
}

// Mixes two layers where one changes again and again: the sum of the others is kept.
void LayerMixer::mixOne(const Layers& layers, size_t layer) {
    if (restOf_ != layer) {
        if (!rest_)
            rest_ = vk::Buffer(kit_.input.device, {.size = composite_.size(), .name = "other layers"});
        run(shares(layers, layer, std::nullopt), nullptr, rest_);
        restOf_ = layer;
    }
    run(shares(layers, std::nullopt, layer), &rest_, composite_);
}

bool LayerMixer::isComplete(const Layers& layers) const {
    if (showsSum()) return sumWhole_;
    return std::all_of(layers.begin(), layers.end(), [](const std::unique_ptr<Layer>& layer) {
        return layer->shown() != nullptr || layer->covered || !layer->shines();
    });
}

bool LayerMixer::showsAny(const Layers& layers) const {
    return lit_ > 0 || isComplete(layers) || showsBounces(layers);
}

bool LayerMixer::showsBounces(const Layers& layers) const {
    return showsSum() || standIn_ ||
           std::any_of(layers.begin(), layers.end(), [](const std::unique_ptr<Layer>& layer) {
               return layer->shown() != nullptr && !layer->covered && layer->shines();
           });
}

bool LayerMixer::mixForViewer(const Layers& layers) {
    if (!isComplete(layers) && !showsBounces(layers)) return mixFirstLight(layers);
    lit_ = 0;
    if (!allChanged_ && changed_.empty()) return false;
    const bool all = std::exchange(allChanged_, false) || sum_ || changed_.size() != 1;
    all ? mix(layers) : mixOne(layers, changed_.front());
    changed_.clear();
    ++version_;
    return true;
}

bool LayerMixer::mixFirstLight(const Layers& layers) {
    const auto lit = static_cast<size_t>(std::count_if(layers.begin(), layers.end(), addsDirect));
    const bool same = lit == lit_ && changed_.empty() && !allChanged_;
    if (same || lit == 0) return false;
    mixDirect(layers, composite_);
    lit_ = lit;
    changed_.clear();
    allChanged_ = false;
    ++version_;
    return true;
}

const vk::Buffer& LayerMixer::mixed(const Layers& layers) {
    mix(layers); // what a viewer was shown is summed in another order
    return composite_;
}

const std::vector<glm::vec4>& LayerMixer::light(const Layers& layers) {
    if (stale_ || light_.empty()) {
        mix(layers);
        light_ =
            vk::readBuffer<glm::vec4>(kit_.input.device, composite_, kit_.input.patches.scene.patches.size());
        stale_ = false;
    }
    return light_;
}

} // namespace relume
