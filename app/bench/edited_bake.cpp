#include "app/bench/edited_bake.h"

#include "app/offline/solve.h"
#include "assets/base/error.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace relume {
namespace {

constexpr LightKey kMoved{.kind = LightKey::Kind::Lamp, .index = 0};

} // namespace

void bakeToEnd(Solver& solver) {
    do {
        solver.step();
        stopIfInterrupted();
    } while (!solver.done());
}

EditedBake::EditedBake(const vk::Device& device, const Scene& scene, WorldMesh mesh,
                       const BakeSettings& settings)
    : device_(device), scene_(scene),
      baker_(std::make_unique<Baker>(device, scene_, std::move(mesh), settings)) {}

void EditedBake::apply(const SceneEdits& edits) {
    const Applied applied = baker_->apply({.scene = edits, .mix = {}});
    ASSERT(applied == Applied::Now);
}

SceneEdits EditedBake::editsTo(const std::vector<Light>& lights) const {
    SceneEdits edits = editsOf(scene_);
    edits.lights = lights;
    return edits;
}

double EditedBake::restart(const std::vector<Light>& lights, const SolverSettings& settings) {
    baker_->restart(editsTo(lights), settings);
    for (const std::unique_ptr<Layer>& layer : solver().layers())
        if (!layer->members.empty())
            throw Error(
                fmt::format("there is no memory for a layer of each of {} lights: give fewer --lights or "
                            "a smaller --size",
                            lightSources(scene_).size()));
    Stopwatch watch;
    watch([&] {
        bakeToEnd(solver());
        solver().liveLight();
    });
    return watch.seconds;
}

// Returns the layer of the first lamp as it stands now, or nullptr until the solver has a result for it.
const Layer* EditedBake::movedLayer() {
    for (const std::unique_ptr<Layer>& layer : solver().layers())
        if (layer->source.key == kMoved && layer->has() &&
            layer->cacheKey.light.transform == scene_.lights.front().transform)
            return layer.get();
    return nullptr;
}

PatchLight EditedBake::firstLamp() {
    const Layer* layer = movedLayer();
    return layer ? solver().layerLight(*layer) : PatchLight();
}

double EditedBake::weigh(const std::vector<Light>& lights) {
    const SceneEdits edits = editsTo(lights);
    Stopwatch watch;
    watch([&] {
        apply(edits);
        solver().liveLight();
    });
    bakeToEnd(solver());
    return watch.seconds;
}

MeasuredMove EditedBake::move(const std::vector<Light>& lights, const MoveReferences& references) {
    const PatchSet& patches = baker_->patches();
    const uint64_t rays = solver().progress().rays;
    const SceneEdits edits = editsTo(lights);
    const glm::vec3 weight = lights.front().color * lights.front().intensity;
    MeasuredMove edit;
    Stopwatch watch;
    LayerLevel seen;
    watch([&] { apply(edits); });
    do {
        watch([&] { solver().step(); });
        stopIfInterrupted();
        const Layer* layer = movedLayer();
        if (!layer || layer->level == seen) continue;
        seen = layer->level;
        const LiveLight live = watch([&] { return solver().liveLight(); });
        const PatchLight own = solver().layerLight(*layer); // for a unit of weight, unlike the reference
        const auto all = vk::readBuffer<glm::vec4>(device_, *live.light, patches.scene.patches.size());
        edit.curve.push_back({.seconds = watch.seconds,
                              .layer = compareLight(patches, own, references.lamp, weight).relRmse,
                              .composite = compareLight(patches, all, references.all).relRmse,
                              .told = layer->error});
    } while (!solver().done());
    ASSERT(!edit.curve.empty());
    const EditErrorPoint &first = edit.curve.front(), &last = edit.curve.back();
    edit.firstSeconds = first.seconds;
    edit.firstLayerError = *first.layer;
    edit.firstCompositeError = first.composite;
    edit.seconds5 = secondsTo(edit.curve, 0.05, true);
    edit.seconds2 = secondsTo(edit.curve, 0.02, true);
    edit.seconds = last.seconds;
    edit.layerError = *last.layer;
    edit.compositeError = last.composite;
    edit.rays = solver().progress().rays - rays;
    return edit;
}

void EditedBake::undo(const std::vector<Light>& lights, const PatchLight& first, MeasuredMove& edit) {
    const SceneEdits edits = editsTo(lights);
    Stopwatch watch;
    watch([&] { apply(edits); });
    do {
        watch([&] { solver().step(); });
        stopIfInterrupted();
    } while (!movedLayer() && !solver().done());
    watch([&] { solver().liveLight(); });
    edit.undoSeconds = watch.seconds;
    bakeToEnd(solver());
    const PatchLight again = firstLamp();
    edit.undoSameBytes = !again.empty() && again.size() == first.size() &&
                         std::memcmp(again.data(), first.data(), first.size() * sizeof(first[0])) == 0;
}

// Bakes to the end of an edit after which this member of all cache keys is no more what it was.
EditedBake::Seen EditedBake::seeLayers(uint64_t LightCacheKey::*changed, uint64_t before, Stopwatch& watch) {
    const auto ready = [&](const std::unique_ptr<Layer>& layer) {
        return layer->cacheKey.*changed != before && layer->has();
    };
    const PatchSet& patches = baker_->patches();
    PatchLight picture;
    Seen seen;
    do {
        watch([&] { solver().step(); });
        stopIfInterrupted();
        const std::vector<std::unique_ptr<Layer>>& layers = solver().layers();
        const bool first = seen.first == 0 && solver().current();
        const bool every = seen.all == 0 && std::all_of(layers.begin(), layers.end(), ready);
        if (!first && !every) continue;
        const LiveLight live = watch([&] { return solver().liveLight(); });
        if (every) seen.all = watch.seconds;
        if (!first) continue;
        seen.first = watch.seconds;
        picture = vk::readBuffer<glm::vec4>(device_, *live.light, patches.scene.patches.size());
    } while (!solver().done());
    watch([&] { solver().liveLight(); });
    seen.end = watch.seconds;
    seen.firstError = compareLight(patches, picture, solver().light()).relRmse;
    return seen;
}

EditedBake::Seen EditedBake::repaint(uint32_t material, const glm::vec4& baseColor) {
    const uint64_t before = solver().layers().front()->cacheKey.surfaces;
    SceneEdits edits = editsOf(scene_);
    edits.materials[material].baseColor = baseColor;
    Stopwatch watch;
    watch([&] { apply(edits); });
    return seeLayers(&LightCacheKey::surfaces, before, watch);
}

std::optional<EditedBake::Replacement> EditedBake::place(uint32_t instance, const glm::mat4& transform,
                                                         const LightmapAtlas& atlas) {
    const uint64_t objects = solver().layers().front()->cacheKey.objects;
    SceneEdits edits = editsOf(scene_);
    edits.placements[instance].transform = transform;
    const double before = baker_->moves().seconds;
    Stopwatch watch;
    const Applied applied =
        watch([&] { return baker_->apply({.scene = edits, .mix = {}, .atlas = &atlas}); });
    ASSERT(applied != Applied::Later);
    if (applied == Applied::NeedsNewBake) return {};
    Replacement times;
    times.follow = baker_->moves().seconds - before;
    times.seen = seeLayers(&LightCacheKey::objects, objects, watch);
    return times;
}

} // namespace relume
