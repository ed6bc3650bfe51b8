#include "fake_bake.h"

#include "bake/layers/layer_bounces.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace relume {
namespace {

constexpr size_t kFakeChunks = 4;
constexpr uint32_t kRaysOfLamp = 4;

} // namespace

FakeBake::FakeBake(const Desc& desc) : desc_(desc), schedule_(desc.rules), store_(desc.room) {
    scene.materials.emplace_back();
    scene.instances.emplace_back();
    for (uint32_t i = 0; i < desc.lamps; ++i)
        addLamp();
    adopt();
}

void FakeBake::addLamp() {
    Light lamp;
    lamp.name = "lamp " + std::to_string(scene.lights.size());
    lamp.transform[3].x = static_cast<float>(scene.lights.size());
    scene.lights.push_back(lamp);
}

void FakeBake::require(bool holds, const std::string& rule) {
    if (holds || !wrong_.empty()) return;
    wrong_ = "after " + std::to_string(steps_.size()) + " steps: " + rule;
}

ScheduleState FakeBake::now() const {
    ScheduleState state;
    state.sum = {.due = sumDue_, .shown = sumShown_};
    state.unseen = unseen_;
    state.relinkSamplePass = relink_;
    if (const auto* direct = std::get_if<Direct>(&job_))
        state.job = ScheduleState::LayerJob{direct->layer->has()};
    else if (const auto* bounce = std::get_if<Bounce>(&job_); bounce && bounce->sum)
        state.job = ScheduleState::SumJob();
    else if (bounce)
        state.job =
            ScheduleState::LayerJob{bounce->lanes.front().left == 0 || bounce->lanes.front().layer->has()};
    return state;
}

// Returns a number that is the same for the same light, place, colours and objects.
uint32_t FakeBake::randomOf(const Layer& layer, uint32_t what) const {
    const auto mixed = [](uint64_t hash, uint64_t word) {
        hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
        return hash ^ (hash >> 29);
    };
    uint64_t hash = mixed(desc_.seed, what);
    const auto add = [&](const LightCacheKey& cacheKey) {
        for (int k = 0; k < 3; ++k)
            hash = mixed(hash, std::bit_cast<uint32_t>(cacheKey.light.transform[3][k]));
    };
    add(layer.cacheKey);
    for (const LightCacheKey& member : layer.cacheKey.members)
        add(member);
    return static_cast<uint32_t>(mixed(mixed(hash, layer.cacheKey.surfaces), layer.cacheKey.objects) >> 32);
}

void FakeBake::step() {
    if (edited_ && schedule_.takesEdits(layers(), now())) adopt();
    if (done_) return;
    const bool drops = LayerSchedule::drops(now());
    if (drops) {
        steps_.emplace_back("drop");
        abort();
    }
    const LayerSchedule::Step next = schedule_.next(layers(), now());
    checkStep(next, drops);
    steps_.push_back(textOf(next));
    if (std::holds_alternative<LayerSchedule::Relink>(next)) {
        relink();
    } else {
        if (std::holds_alternative<LayerSchedule::BeginSum>(next)) beginSum();
        if (const auto* layer = std::get_if<LayerSchedule::BeginLayer>(&next)) begin(*layer);
        done_ = std::holds_alternative<LayerSchedule::Done>(next);
        batch();
    }
    if (schedule_.isWhole(layers(), now())) unseen_ = false;
}

void FakeBake::finish(int most) {
    for (int i = 0; i < most && !done_; ++i)
        step();
    require(done_, "it does not end");
}

// Holds each decision against what a bake may never do.
void FakeBake::checkStep(const LayerSchedule::Step& step, bool dropped) {
    const bool begins = std::holds_alternative<LayerSchedule::BeginSum>(step) ||
                        std::holds_alternative<LayerSchedule::BeginLayer>(step);
    const bool isDone = std::holds_alternative<LayerSchedule::Done>(step);
    require(!isBusy() || (!begins && !isDone), "a job is begun beside another one");
    droppedForSum_ = (droppedForSum_ && std::holds_alternative<LayerSchedule::Relink>(step)) || dropped;
    require(!droppedForSum_ || std::holds_alternative<LayerSchedule::BeginSum>(step) ||
                std::holds_alternative<LayerSchedule::Relink>(step),
            "a job was dropped for something else than the sum");
    require(!isDone || !edited_, "an edit is forgotten");
    require(!isDone || !relink_, "links have not followed objects");
    require(isBusy() || !std::holds_alternative<LayerSchedule::Continue>(step), "nothing goes on");
    require(!std::holds_alternative<LayerSchedule::Relink>(step) || relink_, "no links are to follow");
    const auto* next = std::get_if<LayerSchedule::BeginLayer>(&step);
    if (!next) return;
    const Layer& layer = *layers()[next->layer];
    const LayerLevel last = schedule_.lastLevel();
    require(layer.shines(), "a level is made of what is dark");
    require(next->target.directSamplePasses <= last.directSamplePasses &&
                next->target.linkSamplePasses <= last.linkSamplePasses,
            "a level is beyond the last one");
    require(next->target.directSamplePasses >= layer.level.directSamplePasses &&
                next->target.linkSamplePasses >= layer.level.linkSamplePasses,
            "a level is below the one before");
    require(next->target != layer.level || !layer.dirty.empty(), "a level is made that is there");
    require(!next->directAlone || layer.directSamplePasses < next->target.directSamplePasses ||
                !layer.dirty.empty(),
            "direct light is made that is there");
    const bool later = layer.has() && !next->directAlone && layer.dirty.empty();
    require(!later || std::all_of(layers().begin(), layers().end(),
                                  [](const auto& other) { return other->has() || !other->shines(); }),
            "a later level comes before a first one");
    if (!desc_.rules.live || !layer.dirty.empty()) return;
    require(std::none_of(layers().begin(), layers().end(),
                         [](const auto& other) { return other->shines() && other->isOutdated(); }),
            "a viewer waits for what moved");
}

void FakeBake::checkLanes(const Bounce& job) {
    const Lane& leader = job.lanes.front();
    require(job.lanes.size() <= std::min<size_t>(desc_.lanes, LayerBounces::kMostLanes),
            "too many layers bounce together");
    require(job.lanes.size() == 1 || desc_.rules.together, "layers bounce together on the CPU");
    for (const Lane& lane : job.lanes) {
        require(lane.target.linkSamplePasses == leader.target.linkSamplePasses, "lanes want other links");
        require(schedule_.isHasty(lane.target) == schedule_.isHasty(leader.target), "not all are hasty");
        require(lane.layer->directSamplePasses >= lane.target.directSamplePasses,
                "a lane lacks direct light");
        require(lane.layer->dirty.empty(), "dirty direct light bounces");
        require(lane.layer->shines() || &lane == &leader, "what is dark bounces along");
    }
}

void FakeBake::relink() {
    if (*relink_ < keptSamplePasses_ && ++*relink_ < keptSamplePasses_) return;
    relink_.reset();
}

void FakeBake::batch() {
    if (std::holds_alternative<Direct>(job_))
        endDirect(directBatch());
    else if (std::holds_alternative<Bounce>(job_))
        bounceBatch();
}

void FakeBake::begin(const LayerSchedule::BeginLayer& next) {
    job_ = Direct{layers()[next.layer].get(), next.target, next.directAlone, {}};
    endDirect(beginDirect());
}

FakeBake::End FakeBake::beginDirect() {
    auto& job = std::get<Direct>(job_);
    if (job.layer->dirty.empty())
        return job.layer->directSamplePasses >= job.target.directSamplePasses ? End::Made : End::NotYet;
    if (job.layer->rays() == 0) return End::Repaired;
    job.repaired = job.layer->begun ? 1 : 0;
    return End::NotYet;
}

// Makes a step of direct light in one batch.
FakeBake::End FakeBake::directBatch() {
    auto& job = std::get<Direct>(job_);
    if (job.repaired) return repairBatch(job);
    Layer& layer = *job.layer;
    layer.directSamplePasses =
        std::min(nextDirectStep(layer.directSamplePasses), job.target.directSamplePasses);
    layer.directSteps.push_back(layer.directSamplePasses);
    return layer.directSamplePasses == job.target.directSamplePasses ? End::Made : End::NotYet;
}

FakeBake::End FakeBake::repairBatch(Direct& job) {
    Layer& layer = *job.layer;
    const uint32_t step = (*job.repaired)++;
    const bool last = step + 1 == layer.directSteps.size();
    const bool some = std::find(layer.dirty.begin(), layer.dirty.end(), Layer::kBegun) != layer.dirty.end();
    if (last) return End::Repaired;
    if (step != 0 || (!some && !wantsSum())) return End::NotYet;
    std::replace(layer.dirty.begin(), layer.dirty.end(), Layer::kDirty, Layer::kBegun);
    layer.begun = true;
    return End::Paused;
}

void FakeBake::endDirect(End end) {
    const Direct job = std::get<Direct>(job_);
    if (end == End::NotYet) return;
    if (end == End::Repaired) return endRepair();
    if (end == End::Made && !job.alone) return beginBounces(*job.layer, job.target);
    job_ = std::monostate();
    sumDue_ = canSum();
}

void FakeBake::endRepair() {
    const Direct job = std::get<Direct>(job_);
    const bool outdated = job.layer->isOutdated();
    job.layer->dirty.clear();
    job.layer->begun = false;
    const bool more = schedule_.dirtyLayer(layers()).has_value();
    sumDue_ = canSum() && (outdated || !more);
    job_ = std::monostate();
    if (more || sumDue_ || sumShown_ || relink_) return;
    job_ = Direct{job.layer, job.target, job.alone, {}};
    endDirect(beginDirect());
}

void FakeBake::beginBounces(Layer& leader, LayerLevel target) {
    job_ = std::monostate();
    if (target.linkSamplePasses == 0) return finishLevel(leader, target);
    const auto own = std::find_if(layers().begin(), layers().end(),
                                  [&](const auto& layer) { return layer.get() == &leader; });
    Bounce job{.lanes = {{&leader, target}}};
    for (const size_t i :
         schedule_.companions(layers(), static_cast<size_t>(own - layers().begin()), target)) {
        Layer& layer = *layers()[i];
        const LayerLevel level = schedule_.targetOf(layer);
        if (layer.directSamplePasses >= level.directSamplePasses &&
            job.lanes.size() < LayerBounces::kMostLanes)
            job.lanes.push_back({&layer, level});
    }
    job.lanes.resize(std::min(job.lanes.size(), desc_.lanes));
    constexpr uint32_t kMostBatches = 4;
    for (Lane& lane : job.lanes)
        lane.left = 1 + randomOf(*lane.layer, lane.target.linkSamplePasses) % kMostBatches;
    checkLanes(job);
    keptSamplePasses_ =
        std::max(keptSamplePasses_, std::min(target.linkSamplePasses, 8u)); // those beyond are not kept
    job_ = std::move(job);
}

void FakeBake::beginSum() {
    sumDue_ = false;
    if (!canSum()) return;
    for (const std::unique_ptr<Layer>& layer : layers())
        require(!layer->shines() || (layer->directSamplePasses > 0 && !layer->isOutdated()),
                "the sum lacks direct light");
    require(desc_.rules.live, "nobody sees the sum");
    job_ = Bounce{.lanes = {{&sum_, {0, schedule_.sumSamplePasses(layers())}, 2}}, .sum = true};
}

void FakeBake::bounceBatch() {
    auto& job = std::get<Bounce>(job_);
    bool over = true;
    for (Lane& lane : job.lanes) {
        if (lane.left == 0) continue;
        if (--lane.left == 0 && !job.sum) finishLevel(*lane.layer, lane.target);
        over = over && lane.left == 0;
    }
    if (!over) return;
    sumShown_ = sumShown_ || job.sum;
    job_ = std::monostate();
}

// Noise falls as samples come in, as in a bake.
void FakeBake::finishLevel(Layer& layer, LayerLevel target) {
    const auto noise = [&](uint32_t what) {
        return std::pow(10.0, -6.0 + randomOf(layer, what) % 1000 / 200.0);
    };
    constexpr uint32_t kDirect = 1001, kIndirect = 1002, kLight = 1003;
    const LayerLevel last = schedule_.lastLevel();
    require(target.directSamplePasses <= last.directSamplePasses &&
                target.linkSamplePasses <= last.linkSamplePasses,
            "a level is beyond the last one");
    layer.level = target;
    layer.light = randomOf(layer, kLight) % 10; // every tenth lights nothing
    layer.directVariance = noise(kDirect) / target.directSamplePasses;
    layer.indirectVariance = target.linkSamplePasses > 0 ? noise(kIndirect) / target.linkSamplePasses : 0.0;
    layer.iterationError = 0.1 * std::max(desc_.rules.error, desc_.rules.layerError);
    layer.error = std::sqrt(layer.directVariance + layer.indirectVariance +
                            layer.iterationError * layer.iterationError);
    if (layer.redo == layer.level) {
        layer.redo.reset();
        layer.redoSteps.clear();
    }
    levels_[layer.source.name].push_back(textOf(target));
    if (layer.before) store_->archive(std::move(layer.before));
    schedule_.apportion(layers());
    if (!wantsSum()) sumShown_ = false;
}

void FakeBake::abort() {
    if (const auto* bounce = std::get_if<Bounce>(&job_)) sumDue_ = sumDue_ || bounce->sum;
    job_ = std::monostate();
}

std::vector<WantedLayer> FakeBake::wanted() const {
    return wantedLayers(scene, mix, desc_.room, states_.now());
}

void FakeBake::edit() {
    std::vector<glm::mat4> places;
    for (const Instance& instance : scene.instances)
        places.push_back(instance.transform);
    require(places == places_ || moved_ || atRest(), "the script moves objects before it may");
    moved_ = moved_ || places != places_;
    places_ = places;
    edited_ = true;
    done_ = false;
    weigh();
}

void FakeBake::weigh() {
    const std::vector<WantedLayer> all = wanted();
    const auto has = [&](const LightCacheKey& cacheKey) {
        return std::any_of(layers().begin(), layers().end(),
                           [&](const auto& layer) { return layer->cacheKey == cacheKey; });
    };
    for (const std::unique_ptr<Layer>& layer : layers()) {
        auto wants = std::find_if(all.begin(), all.end(),
                                  [&](const WantedLayer& one) { return one.cacheKey == layer->cacheKey; });
        if (wants == all.end())
            wants = std::find_if(all.begin(), all.end(), [&](const WantedLayer& one) {
                return one.source.key == layer->source.key && !has(one.cacheKey);
            });
        if (wants == all.end() && isRegrouped(*layer, all)) continue;
        layer->source.weight = wants != all.end() ? wants->source.weight : glm::vec3(0.0f);
    }
    schedule_.apportion(layers(), true);
}

void FakeBake::adopt() {
    edited_ = false;
    const SceneState before = states_.now();
    states_.note(scene);
    unseen_ = unseen_ || (!layers().empty() && !(states_.now() == before));
    if (places_.empty()) places_.push_back(scene.instances.front().transform);
    if (moved_) relink_ = 0;
    adoptLayers();
    moved_ = false;
    sumDue_ = canSum();
    if (!wantsSum()) sumShown_ = false;
    done_ = false;
    schedule_.apportion(layers(), true);
}

void FakeBake::adoptLayers() {
    std::vector<std::pair<const Layer*, LightCacheKey>> underWay;
    for (const std::unique_ptr<Layer>& layer : layers())
        if (isUnderWay(layer.get())) underWay.emplace_back(layer.get(), layer->cacheKey);
    const std::vector<WantedLayer> all = wanted();
    store_->replace(all, store_->take(all), std::vector<bool>(all.size(), false),
                    [&](const Layer& from, Layer& to) { inherit(from, to); });
    for (const std::unique_ptr<Layer>& layer : layers()) {
        const size_t lamps = layer->isGroup() ? layer->cacheKey.members.size() : 1;
        layer->parts = {{.rays = kRaysOfLamp * static_cast<uint32_t>(lamps)}};
    }
    for (const auto& [layer, cacheKey] : underWay) {
        const bool dark = store_->holds(layer) && layer->isGroup() && !layer->shines();
        if (!store_->holds(layer) || !(layer->cacheKey == cacheKey) || dark) abort();
    }
}

bool FakeBake::isUnderWay(const Layer* layer) const {
    if (const auto* direct = std::get_if<Direct>(&job_)) return direct->layer == layer;
    const auto* bounce = std::get_if<Bounce>(&job_);
    return bounce && std::any_of(bounce->lanes.begin(), bounce->lanes.end(),
                                 [&](const Lane& lane) { return lane.layer == layer && lane.left > 0; });
}

void FakeBake::inherit(const Layer& from, Layer& to) const {
    LightCacheKey alike = from.cacheKey;
    alike.surfaces = to.cacheKey.surfaces;
    alike.objects = to.cacheKey.objects;
    const bool followed = from.cacheKey.objects == states_.before().objects;
    if (!(alike == to.cacheKey) || !followed || from.directSamplePasses == 0) return;
    to.directSamplePasses = from.directSamplePasses;
    to.directSteps = from.directSteps;
    to.dirty = from.dirty;
    to.begun = from.begun;
    if (moved_) markMoved(to);
    to.redo = from.redo;
    if (!from.redo && from.has()) to.redo = LayerLevel{from.directSamplePasses, from.level.linkSamplePasses};
    to.redoSteps = from.redoSteps;
}

// Marks chunks of which nobody knows why it is they.
void FakeBake::markMoved(Layer& layer) const {
    layer.dirty.resize(kFakeChunks, 0);
    for (uint32_t i = 0; i < kFakeChunks; ++i)
        if (randomOf(layer, i) % 3 == 0) layer.dirty[i] = Layer::kDirty;
    layer.begun =
        layer.begun && std::find(layer.dirty.begin(), layer.dirty.end(), Layer::kDirty) == layer.dirty.end();
    if (std::count(layer.dirty.begin(), layer.dirty.end(), 0) == std::ssize(layer.dirty)) layer.dirty.clear();
}

std::string FakeBake::steps() const {
    std::string text;
    for (size_t i = 0; i < steps_.size();) {
        size_t end = i;
        while (end < steps_.size() && steps_[end] == steps_[i])
            ++end;
        text += (text.empty() ? "" : ", ") + steps_[i];
        if (end - i > 1) text += " x" + std::to_string(end - i);
        i = end;
    }
    return text;
}

} // namespace relume
