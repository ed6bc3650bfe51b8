#include "bake/layers/layer_store.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace relume {
namespace {

// The records hold at most so many cache keys, members of groups counted; each takes a few hundred bytes.
constexpr size_t kMostRecorded = 16384;

} // namespace

bool LayerStore::holds(const Layer* layer) const {
    return std::any_of(layers_.begin(), layers_.end(),
                       [&](const std::unique_ptr<Layer>& own) { return own.get() == layer; });
}

// Takes a spare buffer where there is one: a driver takes longer to find memory than a GPU to fill it.
vk::Buffer LayerStore::takeBuffer(const char* name) {
    if (spare_.empty()) {
        const vk::MemoryOwner owner(kLayerLightOwner);
        const bool fits = device_.ledger().deviceBytesOf(kLayerLightOwner) + lightBytes_ <= deviceBytes_;
        return {device_,
                {.size = lightBytes_, .memory = fits ? vk::Memory::Device : vk::Memory::Host, .name = name}};
    }
    vk::Buffer buffer = std::move(spare_.back());
    spare_.pop_back();
    return buffer;
}

void LayerStore::recycle(Layer& layer) {
    spare_.clear();
    if (layer.direct && layer.direct.use_count() == 1) spare_.push_back(std::move(*layer.direct));
    layer.direct.reset();
    if (layer.result) spare_.push_back(std::move(layer.result));
}

std::vector<std::unique_ptr<Layer>> LayerStore::take(const std::vector<WantedLayer>& wanted) {
    std::vector<std::unique_ptr<Layer>> taken;
    for (const WantedLayer& one : wanted)
        taken.push_back(takeOne(one));
    return taken;
}

std::unique_ptr<Layer> LayerStore::takeOne(const WantedLayer& wanted) {
    const auto fits = [&](const std::unique_ptr<Layer>& layer) {
        return layer && (wanted.isDarkGroup() ? layer->source.key == wanted.source.key
                                              : layer->cacheKey == wanted.cacheKey);
    };
    for (std::vector<std::unique_ptr<Layer>>* from : {&layers_, &former_}) {
        const auto found = std::find_if(from->begin(), from->end(), fits);
        if (found == from->end()) continue;
        std::unique_ptr<Layer> layer = std::move(*found);
        from->erase(found);
        return layer;
    }
    // Nothing came of an edit that was taken back.
    for (const std::unique_ptr<Layer>& layer : layers_)
        if (layer && !layer->has() && fits(layer->before)) return std::move(layer->before);
    return nullptr;
}

void LayerStore::replace(const std::vector<WantedLayer>& wanted, std::vector<std::unique_ptr<Layer>> taken,
                         const std::vector<bool>& covered,
                         const std::function<void(const Layer&, Layer&)>& inherit) {
    for (size_t i = 0; i < wanted.size(); ++i) {
        if (taken[i]) {
            taken[i]->covered = taken[i]->covered || covered[i];
            continue;
        }
        taken[i] = std::make_unique<Layer>();
        Layer& layer = *taken[i];
        layer.cacheKey = wanted[i].cacheKey;
        layer.covered = covered[i];
        const auto same =
            std::find_if(layers_.begin(), layers_.end(), [&](const std::unique_ptr<Layer>& former) {
                return former->source.key == wanted[i].source.key;
            });
        if (same != layers_.end()) inherit(**same, layer);
        recall(layer);
        if (same == layers_.end()) continue;
        layer.covered = std::exchange((*same)->covered, false) || layer.covered;
        std::unique_ptr<Layer> former = std::move(*same);
        layers_.erase(same);
        if (former->has()) {
            layer.before = std::move(former);
            continue;
        }
        layer.before = std::move(former->before);
        recycle(*former);
    }
    for (std::unique_ptr<Layer>& gone : layers_)
        archive(std::move(gone));
    layers_ = std::move(taken);
    for (size_t i = 0; i < wanted.size(); ++i) {
        layers_[i]->source = wanted[i].source;
        layers_[i]->members = wanted[i].members;
    }
}

void LayerStore::archive(std::unique_ptr<Layer> layer) {
    if (layer->before) archive(std::move(layer->before));
    layer->covered = false;
    if (!layer->has()) return recycle(*layer);
    former_.push_back(std::move(layer));
    const uint64_t each = 2 * lightBytes_;
    // As many former layers are kept as there are others where the host holds some.
    const uint64_t most = std::max(deviceBytes_, std::min(bytes_, (2 * layers_.size() + 1) * each));
    while (!former_.empty() && (layers_.size() + former_.size() + 1) * each > most) { // and the spare
        remember(*former_.front());
        recycle(*former_.front());
        former_.erase(former_.begin());
    }
}

std::vector<std::unique_ptr<Layer>> LayerStore::release() {
    former_.clear();
    spare_.clear();
    records_.clear();
    for (const std::unique_ptr<Layer>& layer : layers_)
        layer->before.reset();
    return std::exchange(layers_, {});
}

// Records a layer. One on its way to a level that it had is in the records already.
void LayerStore::remember(const Layer& layer) {
    if (layer.redo) return;
    std::erase_if(records_, [&](const Record& record) { return record.cacheKey == layer.cacheKey; });
    const std::vector<uint32_t>& steps = layer.directSteps; // those made ahead are of no level yet
    const auto end = std::upper_bound(steps.begin(), steps.end(), layer.level.directSamplePasses);
    records_.push_back({layer.cacheKey, layer.level, {steps.begin(), end}});
    const auto count = [](size_t sum, const Record& record) {
        return sum + 1 + record.cacheKey.members.size();
    };
    size_t recorded = std::accumulate(records_.begin(), records_.end(), size_t{0}, count);
    for (; recorded > kMostRecorded && records_.size() > 1; records_.erase(records_.begin()))
        recorded -= count(0, records_.front());
}

// Has a layer made as far as it was when memory was short, in the same steps: an undo brings back the bytes.
// Direct light that it got from another layer must have been made likewise.
void LayerStore::recall(Layer& layer) const {
    const auto found = std::find_if(records_.begin(), records_.end(),
                                    [&](const Record& record) { return record.cacheKey == layer.cacheKey; });
    if (found == records_.end()) return;
    const std::vector<uint32_t>& steps = found->directSteps;
    const auto differs =
        std::mismatch(layer.directSteps.begin(), layer.directSteps.end(), steps.begin(), steps.end());
    if (differs.first != layer.directSteps.end()) {
        layer.direct.reset();
        layer.directSamplePasses = 0;
        layer.directSteps.clear();
        layer.dirty.clear();
        layer.begun = false;
        layer.penumbra.clear();
    }
    layer.redo = found->level;
    layer.redoSteps = steps;
}

} // namespace relume
