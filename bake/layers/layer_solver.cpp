#include "bake/layers/layer_solver.h"

#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "bake/base/finite_light.h"
#include "bake/layers/device_gather.h"
#include "bake/layers/host_gather.h"
#include "bake/layers/layer_memory.h"
#include "bake/layers/layer_state.h"
#include "bake/layers/light_groups.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relume {
namespace {

// The first level is smoothed by this [texels]: its few links are noisy, and there is no time to try more.
constexpr double kFirstSigma = 3.0;

// Returns the width that is likely best [texels]: noise falls as samples come in, so that the best width
// falls, too, as in the Cornell rooms and an atrium, where it is 2 to 4 with 50 directions per patch and .5
// to .7 with 2000. converge() finds what it is.
double likelyWidth(uint32_t samples) {
    constexpr double kLeast = 0.5;
    return std::max(kLeast, kFirstSigma * std::pow(32.0 / std::max(samples, 32u), 0.4));
}

void requireLayers(const SolverSettings& settings) {
    ASSERT(settings.method == Method::Hybrid && !settings.transport.rtrad);
    if (settings.links.indirectScale > 1)
        throw Error("layers have no coarser grid: leave out --indirect-scale");
    if (settings.links.directions != DirectionSet::Sobol)
        throw Error("layers take their directions from the Sobol sequence: leave out --directions");
    if (settings.links.footprint) throw Error("layers have no footprints: leave out --footprint");
}

// Layers keep emission out of what patches send: it is direct light's.
LinkKit::Desc kitOf(const SolverInput& input, SolverSettings settings, SolverProgress& progress,
                    const double& batchMs) {
    requireLayers(settings);
    settings.transport.reflectedOnly = true;
    const uint32_t links =
        linksOfSamplePass(input.patches.count, settings.links.samples, input.device.info().software());
    return {.settings = settings,
            .linksOfSamplePass = links,
            .buffers = {.direct = true, .smooth = settings.links.smooth, .spill = settings.spill},
            .chunks = input.patches.chunkCount(),
            .progress = progress,
            .batchMs = batchMs};
}

std::unique_ptr<LayerGather> makeGather(LinkKit& kit, const LayerPass& pass, const ChunkSenders& senders) {
    if (kit.gatherPass.onCpu()) return std::make_unique<HostGather>(kit, senders);
    return std::make_unique<DeviceGather>(kit, pass);
}

} // namespace

LayerSolver::LayerSolver(const SolverInput& input, const SolverSettings& settings, const LayerCarry* carry)
    : kit_(input, kitOf(input, settings, progress_, batchMs_)), layerPass_(input.device),
      senders_(input.device.workers(), input.patches.scene.patches),
      schedule_({.pointsOfSamplePass = kPointsOfSamplePass,
                 .linksOfSamplePass = kit_.linksOfSamplePass,
                 .samples = settings.links.samples,
                 .passes = settings.passes,
                 .error = settings.error,
                 .localError = settings.localError,
                 .layerError = settings.layers.error,
                 .live = settings.live,
                 .together = !kit_.gatherPass.onCpu(),
                 .costs = kit_.wide() ? kGpuLayerCosts : LayerCosts()}),
      store_(input.device, kit_.lightBytes(), settings.layers.bytes, settings.layers.deviceBytes),
      lights_(kit_), penumbra_(kit_), gather_(makeGather(kit_, layerPass_, senders_)),
      batches_(kit_, {.chunkCount = kit_.chunkCount(),
                      .links = kit_.linksOfSamplePass,
                      .batch = kit_.buffers.batchChunks,
                      .bytes = settings.cache.keepsLinks() ? settings.cache.bytes : 0,
                      .deviceBytes = settings.cache.deviceBytes}),
      directTools_{kit_, layerPass_, lights_, penumbra_, store_, BatchRate(kit_.wide())},
      bounceTools_{kit_, *gather_, batches_, senders_}, mixer_(kit_, layerPass_),
      report_(kit_, schedule_, layerPass_, mixer_), relinker_(kit_, batches_.cache()) {
    batchMs_ = settings.batchMs;
    input.light.resizeRadiance(input.device, kit_.lightBytes()); // another solver had nodes in it
    VkCommandBuffer cmd = kit_.commands.begin();
    for (const vk::Buffer* light : {&input.light.ligIn, &input.light.ligOut})
        vkCmdFillBuffer(cmd, light->handle(), 0, VK_WHOLE_SIZE, 0);
    vkCmdFillBuffer(cmd, kit_.buffers.rays.handle(), 0, VK_WHOLE_SIZE, 0);
    vkCmdFillBuffer(cmd, mixer_.composite().handle(), 0, VK_WHOLE_SIZE, 0);
    kit_.run(cmd);
    adopt();
    unseen_ = settings.live; // all lights are seen in one before any by itself
    if (carry) takeOver(*carry);
}

LayerSolver::~LayerSolver() = default;

bool LayerSolver::holds(size_t lamps) const {
    constexpr size_t kSky = 1;
    const uint64_t room = layerRoom(kit_.input.patches, store_.bytes());
    return room >= kLeastRoom || lamps + lights_.emitterCount() + kSky <= room;
}

ScheduleState LayerSolver::now() const {
    ScheduleState now{.sum = {.due = sumDue_, .shown = mixer_.showsSum()},
                      .unseen = unseen_,
                      .relinkSamplePass = relinker_.samplePass(),
                      .job = {}};
    if (const auto* direct = std::get_if<DirectJob>(&job_))
        now.job = ScheduleState::LayerJob{direct->layer().has()};
    else if (const auto* bounce = std::get_if<BounceJob>(&job_); bounce && bounce->sum())
        now.job = ScheduleState::SumJob();
    else if (bounce)
        now.job = ScheduleState::LayerJob{bounce->leaderHasLevel()};
    return now;
}

void LayerSolver::step() {
    const vk::MemoryOwner owner(kLayersOwner);
    const auto start = Clock::now();
    if (edited_ && schedule_.takesEdits(layers(), now())) adopt();
    if (done_) return;
    if (LayerSchedule::drops(now())) abortPass();
    LayerSchedule::Step next = schedule_.next(layers(), now());
    if (std::holds_alternative<LayerSchedule::Done>(next) && report_.tellAtEnd(layers(), progress_))
        next = schedule_.next(layers(), now());
    if (std::holds_alternative<LayerSchedule::Relink>(next)) {
        relinker_.batch();
    } else {
        if (std::holds_alternative<LayerSchedule::BeginSum>(next)) beginSum();
        if (const auto* layer = std::get_if<LayerSchedule::BeginLayer>(&next)) begin(*layer);
        done_ = std::holds_alternative<LayerSchedule::Done>(next);
        batch();
    }
    if (schedule_.isWhole(layers(), now())) unseen_ = false;
    progress_.seconds += secondsSince(start);
}

// Makes a batch of the job under way, if there is one.
void LayerSolver::batch() {
    if (!isBusy()) return;
    if (auto* direct = std::get_if<DirectJob>(&job_))
        endDirectBatch(direct->batch(wantsSum()));
    else
        bounceBatch();
    progress_.passFraction = 1.0 - static_cast<double>(kit_.order.left()) / std::max(1u, kit_.order.count());
}

void LayerSolver::begin(const LayerSchedule::BeginLayer& next) {
    job_.emplace<DirectJob>(directTools_, *layers()[next.layer], next.target, next.directAlone);
    endDirectBatch(std::get<DirectJob>(job_).begin(wantsSum()));
}

void LayerSolver::endDirectBatch(DirectJob::End end) {
    const DirectJob& job = std::get<DirectJob>(job_);
    switch (end) {
    case DirectJob::End::NotYet:
        return;
    case DirectJob::End::Made:
        if (!job.alone()) return beginBounces(job.layer(), job.target());
        break;
    case DirectJob::End::Paused:
        break;
    case DirectJob::End::Repaired:
        return endRepair();
    }
    job_ = std::monostate();
    sumDue_ = canSum();
}

// Ends a repair. A viewer gets the first step of all direct light first, then all of it, and the sum of all
// lights after either.
void LayerSolver::endRepair() {
    const DirectJob job = std::get<DirectJob>(job_);
    Layer& layer = job.layer();
    const bool outdated = layer.isOutdated();
    layer.dirty.clear();
    layer.begun = false;
    const bool more = schedule_.dirtyLayer(layers()).has_value();
    sumDue_ = canSum() && (outdated || !more);
    job_ = std::monostate();
    if (more || sumDue_ || mixer_.showsSum() || relinker_.samplePass()) return;
    job_.emplace<DirectJob>(directTools_, layer, job.target(), job.alone());
    endDirectBatch(std::get<DirectJob>(job_).begin(wantsSum()));
}

// Begins with the layer itself and others that have all their direct light.
void LayerSolver::beginBounces(Layer& leader, LayerLevel target) {
    std::vector<BounceJob::Lane> lanes = {
        {.layer = &leader, .target = target, .sky = lights_.skyOfLinks(leader)}};
    if (target.linkSamplePasses == 0) {
        job_ = std::monostate();
        return finishLevel(lanes.front(), 0, 0);
    }
    const auto own = std::find_if(layers().begin(), layers().end(), [&](const std::unique_ptr<Layer>& layer) {
        return layer.get() == &leader;
    });
    const auto index = static_cast<size_t>(own - layers().begin());
    for (const size_t i : schedule_.companions(layers(), index, target)) {
        const LayerLevel level = schedule_.targetOf(*layers()[i]);
        if (layers()[i]->directSamplePasses >= level.directSamplePasses &&
            lanes.size() < LayerBounces::kMostLanes)
            lanes.push_back(
                {.layer = layers()[i].get(), .target = level, .sky = lights_.skyOfLinks(*layers()[i])});
    }
    if (lanes.size() > 1) lanes.resize(gather_->room(static_cast<uint32_t>(lanes.size())));
    job_.emplace<BounceJob>(bounceTools_,
                            BounceJob::Desc{.lanes = std::move(lanes), .hasty = schedule_.isHasty(target)});
}

void LayerSolver::bounceBatch() {
    auto& job = std::get<BounceJob>(job_);
    for (const uint32_t index : job.batch()) {
        const BounceJob::Lane& lane = job.lanes()[index];
        lane.layer->plan.hasty = job.endedInHaste(lane);
        finishLevel(lane, index, job.gathers());
    }
    if (job.over()) job_ = std::monostate();
}

// Makes the result of a lane's sums, smoothed by the width that suits it. Returns its sums.
LevelSums LayerSolver::resolveLevel(const BounceJob::Lane& lane, uint32_t index) {
    Layer& layer = *lane.layer;
    const uint32_t links = lane.target.linkSamplePasses;
    if (!layer.result) layer.result = store_.takeBuffer("layer");
    layer.width = {.sigma = likelyWidth(links * kit_.linksOfSamplePass)};
    LevelSums sums;
    const auto at = [&](double sigma) {
        sums = gather_->resolve(index, layer, links, sigma);
        return sums.indirect;
    };
    const bool smooths = links > 0 && kit_.buffers.rows;
    bounceTools_.distancesKnown = bounceTools_.distancesKnown || links > 0;
    if (smooths && !(lane.target == schedule_.firstLevel()))
        layer.width.converge(at);
    else
        at(smooths ? kFirstSigma : 0.0);
    return sums;
}

void LayerSolver::finishLevel(const BounceJob::Lane& lane, uint32_t index, uint32_t gathers) {
    LevelSums sums = resolveLevel(lane, index);
    const glm::dvec4 total = sums.result;
    requireFiniteLight(total.x, total.y + sums.indirect.indirect + sums.indirect.raw);
    Layer& layer = *lane.layer;
    layer.plan.directFall = fallOfVariance(layer.level.directSamplePasses, layer.directVariance,
                                           lane.target.directSamplePasses, total.y, layer.plan.directFall);
    layer.level = lane.target;
    layer.light = total.x;
    layer.count = total.z;
    layer.directVariance = total.y;
    layer.indirectVariance = smoothedVariance(sums.indirect);
    layer.sketch = std::move(sums.sketch);
    // The light that bounces have converged to is gathered once more; of several gathers the last one is what
    // was measured.
    const double more = gathers > 1 ? 1.0 : lane.series.ratio;
    layer.iterationError = kit_.settings.passes > 0 ? 0.0 : lane.series.error * more;
    layer.error = relativeError({layer.light, layer.count, layer.directVariance + layer.indirectVariance},
                                layer.iterationError);
    if (layer.redo == layer.level) {
        layer.redo.reset();
        layer.redoSteps.clear();
    }
    // The counters take the level's own work, whoever bounced along and whatever was begun in vain: it is the
    // light's own history.
    progress_.passes += lane.looked + gathers;
    progress_.pairs += lane.gathered;
    progress_.cacheBytes = batches_.cache().bytes();
    if (&layer != sum_.get()) return showLevel(layer);
    mixer_.showSum(layer.result, layers().size(), allLit(layers()));
    sumDue_ = layer.level.linkSamplePasses < schedule_.sumSamplePasses(layers()) && canSum();
}

void LayerSolver::showLevel(Layer& layer) {
    if (layer.before) store_.archive(std::move(layer.before));
    progress_.samples = std::max(progress_.samples, layer.level.linkSamplePasses * kit_.linksOfSamplePass);
    for (size_t i = 0; i < layers().size(); ++i)
        if (layers()[i].get() == &layer) mixer_.changed(i);
    endStandIn();
    if (!wantsSum()) mixer_.hideSum(layers().size());
    report_.tell(layers(), progress_);
}

void LayerSolver::endStandIn() {
    if (!mixer_.hasStandIn()) return;
    for (const std::unique_ptr<Layer>& layer : layers())
        if (layer->covered && !layer->has() && layer->shines()) return;
    for (const std::unique_ptr<Layer>& layer : layers())
        layer->covered = false;
    mixer_.endStandIn(layers().size());
}

// Bounces all lights in one, for what changes every layer. Direct light is known, so that their weighted sum
// takes no longer to bounce than one layer; layers follow.
void LayerSolver::beginSum() {
    sumDue_ = false;
    if (!canSum()) return; // an edit that is not adopted yet has switched a light on
    if (!sum_) {
        sum_ = std::make_unique<Layer>();
        sum_->direct = std::make_shared<vk::Buffer>(store_.takeBuffer("direct light of all layers"));
    }
    mixer_.mixDirect(layers(), *sum_->direct);
    // The first one is in haste: until it is there, shade has neither the sky nor bounces.
    const LayerLevel target{0, mixer_.showsBounces(layers()) ? schedule_.sumSamplePasses(layers()) : 1};
    // Its first bounce begins with what is shown, as an edit changes part of it.
    glm::vec3 sky(0.0f);
    for (const std::unique_ptr<Layer>& layer : layers())
        sky += layer->source.weight * lights_.skyOfLinks(*layer);
    job_.emplace<BounceJob>(
        bounceTools_, BounceJob::Desc{.lanes = {{.layer = sum_.get(), .target = target, .sky = sky}},
                                      .sum = true,
                                      .hasty = schedule_.isHasty(target),
                                      .first = kit_.settings.passes == 0 ? &mixer_.composite() : nullptr});
}

// Asks the device for rays of direct light, which it counts for as long as a step of many sample passes
// takes.
uint64_t LayerSolver::raysSoFar() {
    if (std::holds_alternative<DirectJob>(job_)) {
        VkCommandBuffer cmd = kit_.commands.begin();
        kit_.recordRayCount(cmd);
        kit_.run(cmd);
        kit_.countRays();
    }
    return progress_.rays;
}

void LayerSolver::abortPass() {
    if (!isBusy()) return;
    raysSoFar();
    const auto* bounce = std::get_if<BounceJob>(&job_);
    sumDue_ = sumDue_ || (bounce && bounce->sum());
    job_ = std::monostate();
    progress_.passFraction = 0;
}

void LayerSolver::setPriority(std::vector<uint8_t> chunkSeen) {
    ASSERT(chunkSeen.empty() || chunkSeen.size() == kit_.chunkCount());
    kit_.seen = std::move(chunkSeen);
    if (isBusy()) kit_.order.prefer(kit_.seen);
}

LiveLight LayerSolver::liveLight() {
    ASSERT(kit_.settings.live);
    std::vector<ChunkRange> ranges;
    if (mixer_.mixForViewer(layers())) ranges = {{0, kit_.chunkCount()}};
    const vk::Buffer* light = mixer_.showsAny(layers()) ? &mixer_.composite() : nullptr;
    return {.light = light,
            .version = mixer_.version(),
            .complete = mixer_.isComplete(layers()),
            .bounced = mixer_.showsBounces(layers()),
            .changed = std::move(ranges)};
}

std::vector<float> LayerSolver::errors() {
    const std::vector<glm::vec4> light = this->light();
    const auto deviation = static_cast<float>(report_.deviation(layers(), light));
    std::vector<float> result;
    for (const glm::vec4& v : light)
        result.push_back(deviation * v.w);
    return result;
}

double LayerSolver::shareOf(const Layer& layer) const {
    const auto weighed = [](const Layer& one) {
        return one.light * double{one.source.weight.r + one.source.weight.g + one.source.weight.b};
    };
    double all = 0;
    for (const std::unique_ptr<Layer>& one : layers())
        all += weighed(*one);
    return all > 0 ? weighed(layer) / all : 0.0;
}

std::vector<glm::vec4> LayerSolver::layerLight(const Layer& layer, std::vector<glm::vec4> light) const {
    light.resize(kit_.input.patches.scene.patches.size());
    if (layer.has())
        vk::download(kit_.input.device, layer.result, light.data(), light.size() * sizeof(glm::vec4));
    else
        std::fill(light.begin(), light.end(), glm::vec4(0.0f));
    return light;
}

// A level under way is begun anew after a restore: it is a pure function of what it began with.
SolverState LayerSolver::state() {
    ASSERT(!done_);
    SolverState state{progress_, progress_.passSeconds, {}};
    for (const std::unique_ptr<Layer>& layer : layers())
        appendLayerState(*layer, {penumbra_.parts().count, kit_.chunkCount()}, state.own);
    return state;
}

std::vector<StatePart> LayerSolver::stateParts() {
    std::vector<StatePart> parts;
    for (const std::unique_ptr<Layer>& layer : layers()) {
        if (!layer->direct)
            layer->direct = std::make_shared<vk::Buffer>(store_.takeBuffer("direct light of a layer"));
        if (!layer->result) layer->result = store_.takeBuffer("layer");
        parts.push_back(part(kit_.input.device, *layer->direct));
        parts.push_back(part(kit_.input.device, layer->result));
    }
    return parts;
}

void LayerSolver::restore(const SolverState& state) {
    const size_t each = layerStateBytes({penumbra_.parts().count, kit_.chunkCount()});
    if (state.own.size() != layers().size() * each)
        throw Error("this state is not of such a solver: bake from the start");
    abortPass();
    const uint64_t cacheBytes = progress_.cacheBytes;
    static_cast<SolverCounters&>(progress_) = state.counters;
    progress_.passSeconds = state.passSeconds;
    progress_.cacheBytes = cacheBytes;
    for (size_t i = 0; i < layers().size(); ++i) {
        takeLayerState(*layers()[i], {penumbra_.parts().count, kit_.chunkCount()},
                       std::span(state.own).subspan(i * each, each));
        mixer_.changed(i);
    }
    done_ = false;
    bounceTools_.distancesKnown = false;
}

} // namespace relume
