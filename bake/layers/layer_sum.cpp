// This part of LayerSolver bounces all lights in one, for what changes every layer. Direct light is known, so
// that their weighted sum takes no longer to bounce than one layer; layers follow.
#include "bake/layers/layer_solver.h"

#include <algorithm>

namespace relume {
namespace {

// The sum's bounces are made of so many links per patch: their noise is then about what hybrid's aim is.
constexpr uint32_t kSumLinks = 64;

bool shines(const Layer& layer) {
    return layer.source.weight != glm::vec3(0.0f);
}

// Tells whether the layer has direct light, made for where objects are.
bool isInSum(const Layer& layer) {
    return layer.directRounds > 0 && !layer.isOutdated();
}

} // namespace

// Tells whether the sum is wanted. One layer alone is seen as soon itself, unless it takes more links. What
// is shown stays until all are there.
bool LayerSolver::wantsSum() const {
    if (!settings_.live || settings_.passes == 1) return false;
    size_t waiting = 0;
    bool deep = false;
    for (const std::unique_ptr<Layer>& layer : layers_) {
        if (!shines(*layer) || layer->has()) continue;
        ++waiting;
        deep = deep || (layer->redo && layer->redo->linkRounds > sumRounds());
    }
    return waiting > 1 || (waiting == 1 && (deep || sumShown_));
}

bool LayerSolver::canSum() const {
    return wantsSum() && std::all_of(layers_.begin(), layers_.end(), [](const std::unique_ptr<Layer>& layer) {
               return !shines(*layer) || isInSum(*layer);
           });
}

// Returns a layer whose direct light is to be made before any layer goes on, so that it is seen among all
// lights.
std::optional<size_t> LayerSolver::unlitLayer() const {
    const bool summed = sumShown_ || (unseen_ && wantsSum());
    for (size_t i = 0; summed && i < layers_.size(); ++i)
        if (shines(*layers_[i]) && layers_[i]->directRounds == 0) return i;
    return std::nullopt;
}

// Returns the sample passes of links that the sum takes.
uint32_t LayerSolver::sumRounds() const {
    return std::max(1u, kSumLinks / linksOfRound_);
}

// Tells whether the links of later sample passes wait before they follow objects that moved: direct light
// comes first, and all is seen in one.
bool LayerSolver::sumComesFirst() const {
    return settings_.live && relink_->round >= sumRounds() &&
           (work_ || sumDue_ || staleLayer() || unlitLayer());
}

bool LayerSolver::current() const {
    return !edited_ && isWhole();
}

// Tells whether what is shown is of the last edit that was adopted.
bool LayerSolver::isWhole() const {
    if (sumDue_ || (work_ && work_->sum)) return false;
    return std::all_of(layers_.begin(), layers_.end(), [&](const std::unique_ptr<Layer>& layer) {
        return !shines(*layer) || (sumShown_ ? isInSum(*layer) : layer->has());
    });
}

void LayerSolver::beginSum() {
    sumDue_ = false;
    if (!canSum()) return; // an edit that is not adopted yet has switched a light on
    if (!sum_) {
        sum_ = std::make_unique<Layer>();
        sum_->direct = std::make_shared<vk::Buffer>(takeBuffer("direct light of all layers"));
    }
    std::vector<shader::LayerWeight> list;
    uint32_t rounds = 1;
    for (const std::unique_ptr<Layer>& layer : layers_) {
        if (!shines(*layer)) continue;
        list.push_back({.light = layer->direct->address(), .weight = layer->source.weight});
        rounds = std::max(rounds, layer->has() ? layer->level.linkRounds
                                               : layer->redo.value_or(LayerLevel()).linkRounds);
    }
    const uint32_t count = writeWeights(list);
    VkCommandBuffer cmd = commands_.begin();
    layerPass_.recordMixDirect(cmd, weights_, count, *sum_->direct);
    run(cmd);
    work_ = Work{.sum = true, .target = {0, std::min(rounds, sumRounds())}};
    beginBounces();
}

void LayerSolver::showSum() {
    sumShown_ = false; // what is shown changes
    for (size_t i = 0; i < layers_.size(); ++i)
        changed(i);
    sumShown_ = true;
}

void LayerSolver::hideSum() {
    if (!sumShown_) return;
    sumShown_ = false;
    restOf_.reset();
    for (size_t i = 0; i < layers_.size(); ++i)
        changed(i);
}

} // namespace relume
