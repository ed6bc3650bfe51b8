// This part of LayerSolver takes up edits: what they leave as it was, and what is to be made anew.
#include "bake/layers/layer_solver.h"

#include "assets/base/error.h"
#include "assets/base/log.h"
#include "bake/layers/dirty_chunks.h"

#include <algorithm>
#include <utility>

namespace relume {

void LayerSolver::edit(const LightMix& mix, bool repainted) {
    mix_ = mix;
    if (repainted) states_.repainted();
    edited_ = true;
    done_ = false;
    weigh();
}

// Weighs the layers that stay what they are; what is not known yet comes with adopt().
void LayerSolver::weigh() {
    const std::vector<WantedLayer> wanted = wantedNow();
    const auto has = [&](const LightCacheKey& cacheKey) {
        return std::any_of(layers().begin(), layers().end(),
                           [&](const std::unique_ptr<Layer>& layer) { return layer->cacheKey == cacheKey; });
    };
    for (size_t i = 0; i < layers().size(); ++i) {
        Layer& layer = *layers()[i];
        auto now = std::find_if(wanted.begin(), wanted.end(),
                                [&](const WantedLayer& w) { return w.cacheKey == layer.cacheKey; });
        // One that was moved shines on from where it was.
        if (now == wanted.end())
            now = std::find_if(wanted.begin(), wanted.end(), [&](const WantedLayer& w) {
                return w.source.key == layer.source.key && !has(w.cacheKey);
            });
        if (now == wanted.end() && isRegrouped(layer, wanted)) continue;
        const glm::vec3 weight = now != wanted.end() ? now->source.weight : glm::vec3(0.0f);
        if (weight == layer.source.weight) continue;
        layer.source.weight = weight;
        mixer_.changed(i);
    }
    report_.tell(layers(), progress_, true);
}

// Returns the layers that are wanted under the surfaces and objects that are known.
std::vector<WantedLayer> LayerSolver::wantedNow() const {
    return wantedLayers(kit_.input.scene, mix_, layerRoom(kit_.input.patches, store_.bytes()), states_.now(),
                        kit_.settings.layers.lights);
}

void LayerSolver::moveObjects(const ObjectMove& move) {
    ASSERT(atRest());
    if (move.instances.empty()) return;
    if (!moved_) moved_.emplace();
    moved_->add(move);
}

void LayerSolver::adopt() {
    edited_ = false;
    const std::string tooMany =
        layerProblem(kit_.input.scene, kit_.input.patches, store_.bytes(), kit_.settings.layers.lights);
    if (!tooMany.empty()) throw Error(tooMany);
    const SceneState before = states_.now();
    states_.note(kit_.input.scene);
    unseen_ = unseen_ || (!layers().empty() && !(states_.now() == before));
    if (moved_) adoptMove();
    std::vector<std::pair<const Layer*, glm::vec3>> shown;
    for (const std::unique_ptr<Layer>& layer : layers())
        shown.emplace_back(layer.get(), layer->source.weight);
    const bool stoodIn = mixer_.hasStandIn();
    adoptLayers();
    lights_.assign(layers());
    tellGroups();
    if (stoodIn || mixer_.hasStandIn() || shown.size() != layers().size()) mixer_.replaced();
    for (size_t i = 0; i < std::min(shown.size(), layers().size()); ++i)
        if (shown[i] != std::pair(static_cast<const Layer*>(layers()[i].get()), layers()[i]->source.weight))
            mixer_.changed(i);
    moved_.reset();
    sumDue_ = canSum();
    if (!wantsSum()) mixer_.hideSum(layers().size());
    done_ = false;
    report_.tell(layers(), progress_, true);
}

// Renews everything that was made of the former scene; layers come after.
void LayerSolver::adoptMove() {
    const PatchSet& patches = kit_.input.patches;
    senders_.update(patches.scene.patches, moved_->changed);
    reachMoved_ = lights_.follow();
    bounceTools_.distancesKnown = false;
    if (moved_->texels) {
        const std::vector<uint32_t>& map = patches.scene.texelToPatch;
        vk::upload(kit_.input.device, kit_.buffers.texelToPatch, map.data(), map.size() * sizeof(map[0]));
    }
    relinker_.follow(*moved_);
}

void LayerSolver::adoptLayers() {
    const auto isUnderWay = [&](const Layer* layer) {
        if (const auto* direct = std::get_if<DirectJob>(&job_)) return &direct->layer() == layer;
        const auto* bounce = std::get_if<BounceJob>(&job_);
        return bounce && bounce->needs(layer);
    };
    // A layer that is under way must be the same one afterwards, not another one at its place in memory.
    std::vector<std::pair<const Layer*, LightCacheKey>> underWay;
    for (const std::unique_ptr<Layer>& layer : layers())
        if (isUnderWay(layer.get())) underWay.emplace_back(layer.get(), layer->cacheKey);
    const std::vector<WantedLayer> wanted = wantedNow();
    std::vector<std::unique_ptr<Layer>> taken = store_.take(wanted);
    const StandInPlan plan = planStandIn(wanted, taken, layers());
    if (plan.regroups) mixer_.beginStandIn(plan.sum, store_.takeBuffer("light of lights grouped anew"));
    store_.replace(wanted, std::move(taken), plan.covered,
                   [&](const Layer& from, Layer& to) { inherit(from, to); });
    endStandIn();
    for (const auto& [layer, cacheKey] : underWay) {
        const bool dark = store_.holds(layer) && layer->isGroup() && !layer->shines(); // has no parts
        if (!store_.holds(layer) || !(layer->cacheKey == cacheKey) || dark) abortPass();
    }
}

// Takes over direct light: surfaces of other colours change bounces alone, objects that moved change direct
// light where it may meet them. The new layer goes as far as the one before was, whose direct light may
// already be that of its next level. The direct light of a group that was dark while objects moved has not
// followed them.
void LayerSolver::inherit(const Layer& from, Layer& to) const {
    LightCacheKey alike = from.cacheKey;
    alike.surfaces = to.cacheKey.surfaces;
    alike.objects = to.cacheKey.objects;
    const bool followed = from.cacheKey.objects == states_.before().objects;
    if (!(alike == to.cacheKey) || !followed || from.directSamplePasses == 0) return;
    to.direct = from.direct;
    to.directSamplePasses = from.directSamplePasses;
    to.directSteps = from.directSteps;
    to.penumbra = from.penumbra;
    to.dirty = from.dirty;
    to.begun = from.begun;
    if (moved_)
        markDirty({.pool = kit_.input.device.workers(),
                   .patches = kit_.input.patches,
                   .parts = penumbra_.parts(),
                   .move = *moved_,
                   .reach = lights_.reach(),
                   .farther = reachMoved_},
                  to);
    to.redo = from.redo;
    if (!from.redo && from.has()) to.redo = LayerLevel{from.directSamplePasses, from.level.linkSamplePasses};
    to.redoSteps = from.redoSteps;
}

// Layers follow all edits first, so that what they leave is of one scene.
FormerLayers LayerSolver::release() {
    abortPass();
    if (edited_) adopt();
    FormerLayers former;
    former.state = states_.now();
    former.pending = relinker_.pending();
    former.links = batches_.cache().release();
    former.linksOfSamplePass = kit_.linksOfSamplePass;
    former.partOfPatch = penumbra_.parts().ofPatch;
    former.reach = lights_.reach();
    former.progress = progress_;
    if (kit_.settings.live && mixer_.isComplete(layers())) former.shown = mixer_.light(layers());
    former.layers = store_.release();
    return former;
}

// Goes on as after an edit of objects, or of nothing at all. A viewer sees what was shown until then.
void LayerSolver::takeOver(const LayerCarry& carry) {
    progress_ = carry.former.progress;
    progress_.passFraction = 0;
    const CarriedWork work = carryLayers(kit_, store_, batches_.cache(),
                                         {.pool = kit_.input.device.workers(),
                                          .patches = kit_.input.patches,
                                          .parts = penumbra_.parts(),
                                          .move = carry.move,
                                          .reach = lights_.reach(),
                                          .farther = carry.former.reach != lights_.reach()},
                                         carry);
    if (work.relink) relinker_.follow(*work.relink);
    progress_.cacheBytes = batches_.cache().bytes();
    unseen_ = !work.whole;
    if (!work.whole && kit_.settings.live && !carry.former.shown.empty()) {
        mixer_.beginStandIn(carryShown(carry, kit_.input.patches),
                            store_.takeBuffer("light of the bake before"));
        for (const std::unique_ptr<Layer>& layer : layers())
            layer->covered = true;
    }
    sumDue_ = canSum();
    mixer_.replaced();
    report_.tell(layers(), progress_, true);
    spdlog::info("the bake goes on: {} of {} patches stay, and {} of {} layers have direct light",
                 carry.patches.kept, kit_.input.patches.count, work.layers, layers().size());
}

void LayerSolver::tellGroups() {
    std::string text;
    long groups = 0;
    for (const std::unique_ptr<Layer>& layer : layers()) {
        if (!layer->isGroup()) continue;
        ++groups;
        text += fmt::format("{}'{}' ({} lights)", text.empty() ? "" : ", ", layer->source.name,
                            layer->members.size());
    }
    if (text == std::exchange(toldGroups_, text) || text.empty()) return;
    spdlog::info("layers: {} lights have their own, others share {}: there is memory for {} in all",
                 static_cast<long>(layers().size()) - groups, text,
                 layerRoom(kit_.input.patches, store_.bytes()));
}

} // namespace relume
