// This part of LayerSolver decides what an edit leaves as it was, and what it makes anew.
#include "bake/layers/layer_solver.h"

#include "assets/base/error.h"
#include "assets/base/log.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace relume {
namespace {

using Kind = LightKey::Kind;

// The records hold at most so many cache keys, members of groups counted; each takes a few hundred bytes.
constexpr size_t kMostRecorded = 16384;

// Returns FNV-1a of all base colour factors.
uint64_t surfacesOf(const Scene& scene) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (const Material& material : scene.materials) {
        for (int k = 0; k < 3; ++k)
            hash = (hash ^ std::bit_cast<uint32_t>(material.baseColor[k])) * 0x100000001b3u;
    }
    return hash;
}

// Returns the same of where objects stand. Hidden ones stand nowhere.
uint64_t objectsOf(const Scene& scene) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (const Instance& instance : scene.instances) {
        hash = (hash ^ instance.hidden) * 0x100000001b3u;
        for (int k = 0; k < 16 && !instance.hidden; ++k)
            hash = (hash ^ std::bit_cast<uint32_t>(instance.transform[k / 4][k % 4])) * 0x100000001b3u;
    }
    return hash;
}

} // namespace

void LayerSolver::edit(const LightMix& mix) {
    ASSERT(atRest() || surfacesOf(input_.scene) == surfaces_);
    ASSERT(moved_ || objectsOf(input_.scene) == objects_);
    mix_ = mix;
    edited_ = true;
    done_ = false;
    weigh();
}

// Weighs the layers that stay what they are; what is not known yet comes with adopt().
void LayerSolver::weigh() {
    const std::vector<Wanted> wanted = wantedLayers();
    const auto has = [&](const LightPattern& pattern) {
        return std::any_of(layers_.begin(), layers_.end(),
                           [&](const std::unique_ptr<Layer>& layer) { return layer->pattern == pattern; });
    };
    for (size_t i = 0; i < layers_.size(); ++i) {
        Layer& layer = *layers_[i];
        auto now = std::find_if(wanted.begin(), wanted.end(),
                                [&](const Wanted& w) { return w.pattern == layer.pattern; });
        // One that was moved shines on from where it was.
        if (now == wanted.end())
            now = std::find_if(wanted.begin(), wanted.end(), [&](const Wanted& w) {
                return w.source.key == layer.source.key && !has(w.pattern);
            });
        if (now == wanted.end() && isRegrouped(layer, wanted)) continue;
        const glm::vec3 weight = now != wanted.end() ? now->source.weight : glm::vec3(0.0f);
        if (weight == layer.source.weight) continue;
        layer.source.weight = weight;
        changed(i);
    }
    tellError();
}

std::unique_ptr<Layer> LayerSolver::makeLayer(const LightPattern& pattern) const {
    auto layer = std::make_unique<Layer>();
    layer->pattern = pattern;
    return layer;
}

// Takes a spare buffer where there is one: a driver takes longer to find memory than a GPU to fill it.
vk::Buffer LayerSolver::takeBuffer(const char* name) {
    if (spare_.empty())
        return {input_.device, {.size = LightBuffers::lightBytes(input_.patches), .name = name}};
    vk::Buffer buffer = std::move(spare_.back());
    spare_.pop_back();
    return buffer;
}

void LayerSolver::recycle(Layer& layer) {
    spare_.clear();
    if (layer.direct && layer.direct.use_count() == 1) spare_.push_back(std::move(*layer.direct));
    layer.direct.reset();
    if (layer.result) spare_.push_back(std::move(layer.result));
}

// Takes a layer from those that are or were there; returns nullptr where none is like this. A group of which
// nothing shines stays as it is, for it may shine again.
std::unique_ptr<Layer> LayerSolver::takeLayer(const Wanted& wanted) {
    const auto fits = [&](const std::unique_ptr<Layer>& layer) {
        return layer && (wanted.isDarkGroup() ? layer->source.key == wanted.source.key
                                              : layer->pattern == wanted.pattern);
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

// Keeps a layer for an undo, as long as there is memory for it.
void LayerSolver::archive(std::unique_ptr<Layer> layer) {
    if (layer->before) archive(std::move(layer->before));
    layer->covered = false;
    if (!layer->has()) return recycle(*layer);
    former_.push_back(std::move(layer));
    const uint64_t each = 2 * LightBuffers::lightBytes(input_.patches);
    while (!former_.empty() && (layers_.size() + former_.size() + 1) * each > layerBytes_) { // and the spare
        remember(*former_.front());
        recycle(*former_.front());
        former_.erase(former_.begin());
    }
}

// Records a layer. One on its way to a level that it had is in the records already.
void LayerSolver::remember(const Layer& layer) {
    if (layer.redo) return;
    std::erase_if(records_, [&](const Record& record) { return record.pattern == layer.pattern; });
    const std::vector<uint32_t>& steps = layer.directSteps; // those made ahead are of no level yet
    const auto end = std::upper_bound(steps.begin(), steps.end(), layer.level.directRounds);
    records_.push_back({layer.pattern, layer.level, {steps.begin(), end}});
    const auto count = [](size_t sum, const Record& record) {
        return sum + 1 + record.pattern.members.size();
    };
    size_t recorded = std::accumulate(records_.begin(), records_.end(), size_t{0}, count);
    for (; recorded > kMostRecorded && records_.size() > 1; records_.erase(records_.begin()))
        recorded -= count(0, records_.front());
}

// Has a layer made as far as it was when memory was short, in the same steps: an undo brings back the bytes.
// Direct light that it got from another layer must have been made likewise.
void LayerSolver::recall(Layer& layer) const {
    const auto found = std::find_if(records_.begin(), records_.end(),
                                    [&](const Record& record) { return record.pattern == layer.pattern; });
    if (found == records_.end()) return;
    const std::vector<uint32_t>& steps = found->directSteps;
    const auto differs =
        std::mismatch(layer.directSteps.begin(), layer.directSteps.end(), steps.begin(), steps.end());
    if (differs.first != layer.directSteps.end()) {
        layer.direct.reset();
        layer.directRounds = 0;
        layer.directSteps.clear();
        layer.stale.clear();
        layer.begun = false;
        layer.penumbra.clear();
    }
    layer.redo = found->level;
    layer.redoSteps = steps;
}

// Takes over direct light: surfaces of other colours change bounces alone, objects that moved change direct
// light where it may meet them. The new layer goes as far as the one before was, whose direct light may
// already be that of its next level. The direct light of a group that was dark while objects moved has not
// followed them.
void LayerSolver::keepDirect(const Layer& from, Layer& to) const {
    LightPattern alike = from.pattern;
    alike.surfaces = to.pattern.surfaces;
    alike.objects = to.pattern.objects;
    if (!(alike == to.pattern) || from.pattern.objects != objectsBefore_ || from.directRounds == 0) return;
    to.direct = from.direct;
    to.directRounds = from.directRounds;
    to.directSteps = from.directSteps;
    to.penumbra = from.penumbra;
    keepStale(from, to);
    to.redo = from.redo;
    if (!from.redo && from.has()) to.redo = LayerLevel{from.directRounds, from.level.linkRounds};
    to.redoSteps = from.redoSteps;
}

// Returns where the solver notes the indices of layers that are under way.
std::vector<size_t*> LayerSolver::layersUnderWay() {
    std::vector<size_t*> places;
    if (!work_) return places;
    if (work_->lanes.empty()) places.push_back(&work_->layer);
    for (Lane& lane : work_->lanes)
        if (lane.live || work_->stage == Stage::Bounces) places.push_back(&lane.layer);
    return places;
}

// Tells whether an edit is taken now: what comes again and again, sixty times a second, waits until the
// picture of the one before is shown.
bool LayerSolver::takesEdits() const {
    if (sumDue_ || unlitLayer()) return false;
    return !work_ || (!work_->sum && (sumShown_ || layers_[work_->layer]->has()));
}

void LayerSolver::adopt() {
    edited_ = false;
    const std::vector<size_t*> places = layersUnderWay();
    std::vector<LightPattern> working;
    for (const size_t* place : places)
        working.push_back(layers_[*place]->pattern);
    const std::string tooMany = problem(input_.scene, input_.patches, layerBytes_);
    if (!tooMany.empty()) throw Error(tooMany);
    const uint64_t surfaces = surfacesOf(input_.scene), objects = objectsOf(input_.scene);
    unseen_ = unseen_ || (!layers_.empty() && (surfaces != surfaces_ || objects != objects_));
    surfaces_ = surfaces;
    objectsBefore_ = std::exchange(objects_, objects);
    if (moved_) adoptMove();
    std::vector<std::pair<const Layer*, glm::vec3>> shown;
    for (const std::unique_ptr<Layer>& layer : layers_)
        shown.emplace_back(layer.get(), layer->source.weight);
    const bool standIn = static_cast<bool>(standIn_);
    adoptLayers(wantedLayers());
    updateParts();
    tellGroups();
    for (size_t i = 0; i < places.size() && work_; ++i) {
        const auto found =
            std::find_if(layers_.begin(), layers_.end(),
                         [&](const std::unique_ptr<Layer>& layer) { return layer->pattern == working[i]; });
        const bool dark = found != layers_.end() && (*found)->source.key.kind == Kind::Group &&
                          (*found)->source.weight == glm::vec3(0.0f); // has no parts
        if (found == layers_.end() || dark)
            abortPass();
        else
            *places[i] = static_cast<size_t>(found - layers_.begin());
    }
    if (work_) work_->layer = *places.front();
    const bool all = standIn || standIn_ || shown.size() != layers_.size();
    if (all) allChanged();
    for (size_t i = 0; !all && i < layers_.size(); ++i)
        if (shown[i] != std::pair(static_cast<const Layer*>(layers_[i].get()), layers_[i]->source.weight))
            changed(i);
    moved_.reset();
    sumDue_ = canSum();
    if (!wantsSum()) hideSum();
    done_ = false;
    tellError();
}

void LayerSolver::adoptLayers(const std::vector<Wanted>& wanted) {
    std::vector<std::unique_ptr<Layer>> next(wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i)
        next[i] = takeLayer(wanted[i]);
    const std::vector<bool> covered = beginStandIn(wanted, next);
    for (size_t i = 0; i < wanted.size(); ++i) {
        if (next[i]) {
            next[i]->covered = next[i]->covered || covered[i];
            continue;
        }
        next[i] = makeLayer(wanted[i].pattern);
        next[i]->covered = covered[i];
        const auto same =
            std::find_if(layers_.begin(), layers_.end(), [&](const std::unique_ptr<Layer>& layer) {
                return layer->source.key == wanted[i].source.key;
            });
        if (same != layers_.end()) keepDirect(**same, *next[i]);
        recall(*next[i]);
        if (same == layers_.end()) continue;
        next[i]->covered = std::exchange((*same)->covered, false) || next[i]->covered;
        std::unique_ptr<Layer> former = std::move(*same);
        layers_.erase(same);
        if (former->has()) {
            next[i]->before = std::move(former);
            continue;
        }
        next[i]->before = std::move(former->before);
        recycle(*former);
    }
    for (std::unique_ptr<Layer>& gone : layers_)
        archive(std::move(gone));
    layers_ = std::move(next);
    for (size_t i = 0; i < wanted.size(); ++i) {
        layers_[i]->source = wanted[i].source;
        layers_[i]->members = wanted[i].members;
    }
    endStandIn();
}

} // namespace relume
