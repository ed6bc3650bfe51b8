// Of LayerSolver: what an edit leaves as it was, and what it makes anew.
#include "bake/layer_solver.h"

#include "assets/error.h"
#include "assets/log.h"

#include <algorithm>
#include <bit>

namespace relume {
namespace {

using Kind = LightKey::Kind;

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;

// Emitters' groups and lamps' are counted apart.
uint32_t groupOf(const std::vector<LightKey>& emitters, const Scene& scene, const LightKey& key) {
    if (key.kind == Kind::Lamp) return key.index;
    if (key.kind == Kind::Sky) return static_cast<uint32_t>(scene.lights.size());
    return static_cast<uint32_t>(std::find(emitters.begin(), emitters.end(), key) - emitters.begin());
}

// FNV-1a of all base colour factors.
uint64_t surfacesOf(const Scene& scene) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (const Material& material : scene.materials) {
        for (int k = 0; k < 3; ++k)
            hash = (hash ^ std::bit_cast<uint32_t>(material.baseColor[k])) * 0x100000001b3u;
    }
    return hash;
}

// The same of where objects stand. Hidden ones stand nowhere.
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

std::string LayerSolver::problem(const Scene& scene, const PatchSet& patches, uint64_t bytes) {
    const size_t lights = lightSources(scene).size();
    const uint64_t needed = lights * 2 * LightBuffers::lightBytes(patches);
    if (needed <= bytes) return "";
    return fmt::format("layers of {} lights take {:.1f} GiB, {:.1f} may be taken: use a smaller lightmap, or "
                       "bake without layers",
                       lights, static_cast<double>(needed) / kGiB, static_cast<double>(bytes) / kGiB);
}

bool LayerSolver::holds(size_t lamps) const {
    const size_t others = emitterKeys_.size() + 1; // and the sky
    return (lamps + others) * 2 * LightBuffers::lightBytes(input_.patches) <= layerBytes_;
}

void LayerSolver::edit(const LightMix& mix) {
    ASSERT(atRest() || surfacesOf(input_.scene) == surfaces_);
    ASSERT(moved_ || objectsOf(input_.scene) == objects_);
    mix_ = mix;
    edited_ = true;
    done_ = false;
    weigh();
}

// Of those that stay what they are; what is not known yet comes with adopt().
void LayerSolver::weigh() {
    const std::vector<LightSource> sources = lightSources(input_.scene);
    std::vector<LightPattern> patterns;
    for (const LightSource& source : sources) {
        patterns.push_back(patternOf(input_.scene, source.key));
        patterns.back().surfaces = surfaces_;
        patterns.back().objects = objects_;
    }
    const auto has = [&](const LightPattern& pattern) {
        return std::any_of(layers_.begin(), layers_.end(),
                           [&](const std::unique_ptr<Layer>& layer) { return layer->pattern == pattern; });
    };
    for (size_t i = 0; i < layers_.size(); ++i) {
        Layer& layer = *layers_[i];
        auto now = sources.end();
        for (auto source = sources.begin(); source != sources.end() && now == sources.end(); ++source)
            if (patterns[static_cast<size_t>(source - sources.begin())] == layer.pattern) now = source;
        // One that was moved shines on from where it was.
        for (auto source = sources.begin(); source != sources.end() && now == sources.end(); ++source)
            if (source->key == layer.source.key &&
                !has(patterns[static_cast<size_t>(source - sources.begin())]))
                now = source;
        const glm::vec3 weight =
            now != sources.end() && mix_.shines(now->key) ? now->weight : glm::vec3(0.0f);
        if (weight == layer.source.weight) continue;
        layer.source.weight = weight;
        changed(i);
        sumDue_ = sumDue_ || sumShown_;
    }
    tellError();
}

std::unique_ptr<Layer> LayerSolver::makeLayer(const LightPattern& pattern) const {
    auto layer = std::make_unique<Layer>();
    layer->pattern = pattern;
    return layer;
}

// A driver takes longer to find memory than a GPU to fill it.
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

// From those that are or were there; nullptr: none is like this.
std::unique_ptr<Layer> LayerSolver::takeLayer(const LightPattern& pattern) {
    for (std::vector<std::unique_ptr<Layer>>* from : {&layers_, &former_}) {
        const auto found = std::find_if(from->begin(), from->end(), [&](const std::unique_ptr<Layer>& layer) {
            return layer && layer->pattern == pattern;
        });
        if (found == from->end()) continue;
        std::unique_ptr<Layer> layer = std::move(*found);
        from->erase(found);
        return layer;
    }
    return nullptr;
}

// Kept for an undo, as long as there is memory for it.
void LayerSolver::archive(std::unique_ptr<Layer> layer) {
    if (layer->before) archive(std::move(layer->before));
    if (!layer->has()) return recycle(*layer);
    former_.push_back(std::move(layer));
    const uint64_t each = 2 * LightBuffers::lightBytes(input_.patches);
    while (!former_.empty() && (layers_.size() + former_.size() + 1) * each > layerBytes_) { // and the spare
        recycle(*former_.front());
        former_.erase(former_.begin());
    }
}

// Surfaces of other colours change bounces alone, objects that moved direct light where it may meet them. The
// new layer goes as far as the one before was.
void LayerSolver::keepDirect(const Layer& from, Layer& to) const {
    LightPattern alike = from.pattern;
    alike.surfaces = to.pattern.surfaces;
    alike.objects = to.pattern.objects;
    if (!(alike == to.pattern) || from.directRounds == 0) return;
    to.direct = from.direct;
    to.directRounds = from.directRounds;
    to.directSteps = from.directSteps;
    to.penumbra = from.penumbra;
    keepStale(from, to);
    to.redo = from.has() ? std::optional(from.level) : from.redo;
}

void LayerSolver::updateEmitters(const std::vector<LightSource>& sources) {
    std::vector<LightKey> keys;
    for (const LightSource& source : sources)
        if (source.key.kind == Kind::Emitter) keys.push_back(source.key);
    if (keys == emitterKeys_) return;
    const TraceScene& scene = input_.patches.scene;
    std::vector<EmitterSet> sets;
    for (const LightKey& key : keys)
        sets.push_back(buildEmitters(input_.scene, scene.mesh, {.size = scene.size, .only = key}));
    emitters_.setGroups(sets);
    emitterKeys_ = std::move(keys);
}

void LayerSolver::adopt() {
    edited_ = false;
    if (work_ && work_->sum) work_.reset();
    const std::optional<LightPattern> working =
        work_ ? std::optional(layers_[work_->layer]->pattern) : std::nullopt;
    const std::vector<LightSource> sources = lightSources(input_.scene);
    const std::string tooMany = problem(input_.scene, input_.patches, layerBytes_);
    if (!tooMany.empty()) throw Error(tooMany);
    surfaces_ = surfacesOf(input_.scene);
    objects_ = objectsOf(input_.scene);
    if (moved_) adoptMove();
    lamps_.update(input_.scene);
    updateEmitters(sources);
    std::vector<LightPattern> patterns;
    for (const LightSource& source : sources) {
        patterns.push_back(patternOf(input_.scene, source.key));
        patterns.back().surfaces = surfaces_;
        patterns.back().objects = objects_;
    }
    std::vector<const Layer*> shown;
    for (const std::unique_ptr<Layer>& layer : layers_)
        shown.push_back(layer.get());
    std::vector<std::unique_ptr<Layer>> next(sources.size());
    for (size_t i = 0; i < sources.size(); ++i)
        next[i] = takeLayer(patterns[i]);
    for (size_t i = 0; i < sources.size(); ++i) {
        if (next[i]) continue;
        next[i] = makeLayer(patterns[i]);
        const auto same =
            std::find_if(layers_.begin(), layers_.end(), [&](const std::unique_ptr<Layer>& layer) {
                return layer->source.key == sources[i].key;
            });
        if (same == layers_.end()) continue;
        keepDirect(**same, *next[i]);
        next[i]->before = std::move(*same);
        layers_.erase(same);
    }
    for (std::unique_ptr<Layer>& gone : layers_)
        archive(std::move(gone));
    layers_ = std::move(next);
    for (size_t i = 0; i < sources.size(); ++i) {
        Layer& layer = *layers_[i];
        layer.source = sources[i];
        if (!mix_.shines(layer.source.key)) layer.source.weight = glm::vec3(0.0f);
        layer.group = groupOf(emitterKeys_, input_.scene, layer.source.key);
    }
    const auto found = std::find_if(layers_.begin(), layers_.end(), [&](const std::unique_ptr<Layer>& layer) {
        return working && layer->pattern == *working;
    });
    if (work_ && found == layers_.end())
        abortPass();
    else if (work_)
        work_->layer = static_cast<size_t>(found - layers_.begin());
    const bool same =
        std::equal(shown.begin(), shown.end(), layers_.begin(), layers_.end(),
                   [](const Layer* a, const std::unique_ptr<Layer>& b) { return a == b.get(); });
    if (!same) {
        restOf_.reset();
        changed_.clear();
        for (size_t i = 0; i < layers_.size(); ++i)
            changed(i);
    }
    moved_.reset();
    sumDue_ = wantsSum();
    if (!sumDue_) hideSum();
    done_ = false;
    tellError();
}

} // namespace relume
