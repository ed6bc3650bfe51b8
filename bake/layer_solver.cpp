#include "bake/layer_solver.h"

#include "assets/error.h"
#include "bake/point_trace.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

using shader::kChunk;

// Of the error that is asked for, what bounces may leave.
constexpr double kIterationShare = 0.2;
constexpr double kLeastIterationError = 1e-4;
// Of the first level, which is in haste.
constexpr double kFirstIterationError = 0.01;
// A GPU is not filled by less than this: unseen chunks that take no longer come along with seen ones.
constexpr double kWorthASubmit = 0.5; // [ms]

const SolverInput& checked(const SolverInput& input, const SolverSettings& settings) {
    ASSERT(settings.method == Method::Hybrid && !settings.transport.rtrad);
    if (settings.links.indirectScale > 1)
        throw Error("layers have no coarser grid: leave out --indirect-scale");
    if (settings.links.directions != DirectionSet::Sobol)
        throw Error("layers take their directions from the Sobol sequence: leave out --directions");
    if (settings.links.footprint) throw Error("layers have no footprints: leave out --footprint");
    return input;
}

} // namespace

LayerSolver::LayerSolver(const SolverInput& input, const SolverSettings& settings)
    : input_(checked(input, settings)), settings_(settings),
      linksOfRound_(
          relume::linksOfRound(input.patches.count, settings.links.samples, input.device.info().software())),
      emitters_(input.device, input.patches, kPointsOfRound),
      lamps_(input.device, input.scene, input.patches, {.samples = kPointsOfRound, .apart = true}),
      buffers_(input.device, input.patches,
               {.linksOfRound = linksOfRound_, .direct = true, .smooth = settings.links.smooth}),
      links_(input.device, {.chunkCount = input.patches.chunkCount(),
                            .links = linksOfRound_,
                            .batch = buffers_.batchChunks,
                            .bytes = settings.cache.keepsLinks() ? settings.cache.bytes : 0}),
      radiancePass_(input.device), gatherPass_(input.device, settings.transport), resolvePass_(input.device),
      layerPass_(input.device), commands_(input.device), timestamps_(input.device, 3),
      order_(input.patches.chunkCount()), layerBytes_(settings.layers.bytes) {
    batchMs_ = settings.batchMs;
    settings_.transport.reflectedOnly = true;
    const VkDeviceSize lightBytes = LightBuffers::lightBytes(input.patches);
    if (input.light.radiance.size() != lightBytes) // another solver's nodes
        input.light.radiance = vk::Buffer(input.device, {.size = lightBytes, .name = "radiance"});
    if (!gatherPass_.onCpu())
        buffers_.packed =
            vk::Buffer(input.device, {.size = lightBytes / sizeof(glm::vec4) * sizeof(glm::uvec2),
                                      .name = "packed radiance"});
    composite_ = vk::Buffer(input.device, {.size = lightBytes, .name = "composite"});
    const std::vector<shader::Patch>& patches = input.patches.scene.patches;
    senders_.assign(input.patches.chunkCount(), 0);
    for (size_t i = 0; i < patches.size(); ++i)
        senders_[i / kChunk] += (patches[i].flags & shader::kPatchSends) != 0;
    VkCommandBuffer cmd = commands_.begin();
    for (const vk::Buffer* buffer : {&buffers_.rays, &composite_, &input.light.ligIn, &input.light.ligOut})
        vkCmdFillBuffer(cmd, buffer->handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    edited_ = true;
    adopt();
}

LayerSolver::~LayerSolver() = default;

void LayerSolver::step() {
    const auto start = Clock::now();
    if (edited_ && (!work_ || layers_[work_->layer]->has())) adopt();
    if (done_) return;
    if (!work_) plan();
    if (work_) {
        if (work_->stage == Stage::Direct)
            directBatch();
        else
            linkBatch();
        progress_.passFraction = 1.0 - static_cast<double>(order_.left()) / std::max(1u, order_.count());
    }
    progress_.seconds += secondsSince(start);
}

void LayerSolver::plan() {
    const std::optional<size_t> next = nextLayer();
    if (!next) {
        done_ = true;
        return;
    }
    const Layer& layer = *layers_[*next];
    begin(*next, layer.has() ? nextLevel(layer) : layer.redo.value_or(firstLevel()));
}

void LayerSolver::begin(size_t layer, LayerLevel target) {
    work_ = Work{.layer = layer, .target = target};
    work_->round = layers_[layer]->directRounds;
    if (work_->round >= target.directRounds) return beginBounces();
    VkCommandBuffer cmd = commands_.begin();
    vkCmdFillBuffer(cmd, buffers_.directSums.handle(), 0, VK_WHOLE_SIZE, 0);
    beginPass(cmd);
    if (raysOf(*layers_[layer]) == 0) { // nothing in it shines
        work_->round = target.directRounds - 1;
        endDirectRound();
    }
}

// Ends the command buffer and makes all chunks wait for their turn.
void LayerSolver::beginPass(VkCommandBuffer cmd) {
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    order_.begin(input_.patches.chunkCount(), seen_);
}

uint32_t LayerSolver::raysOf(const Layer& layer) const {
    if (layer.source.key.kind == LightKey::Kind::Emitter) return emitters_.rays(layer.group);
    return layer.group < lamps_.groups() ? lamps_.rays(layer.group) : 0;
}

ChunkRange LayerSolver::nextRange(const BatchRate& rate, uint32_t most) const {
    const double limit = std::clamp(rate.wanted(batchMs_), 1.0, std::max(1.0, static_cast<double>(most)));
    return order_.next(static_cast<uint32_t>(limit), static_cast<uint32_t>(rate.perMs() * kWorthASubmit));
}

void LayerSolver::directBatch() {
    const Layer& layer = *layers_[work_->layer];
    const bool emitter = layer.source.key.kind == LightKey::Kind::Emitter;
    const ChunkRange range = nextRange(directRate_, emitter ? emitters_.batchChunks() : lamps_.batchChunks());
    const auto start = Clock::now();
    if (emitter)
        directBatchOf(emitters_, layer.group, range);
    else
        directBatchOf(lamps_, layer.group, range);
    directRate_.note(range.count, batchMs_, secondsSince(start));
    order_.finish(range);
    if (order_.left() == 0) endDirectRound();
}

template<typename Lights>
void LayerSolver::directBatchOf(const Lights& lights, uint32_t group, ChunkRange range) {
    const typename Lights::Work work{.group = group, .round = work_->round, .range = range};
    const PointTimes times = tracePoints(
        {commands_, timestamps_, input_.tracer}, lights.segments(work, buffers_.rays),
        [&](VkCommandBuffer cmd) { lights.recordSamples(cmd, input_.light, work); },
        [&](VkCommandBuffer cmd) {
            lights.recordGather(cmd, input_.light, work, buffers_.directSums, buffers_.direct);
        });
    progress_.traceSeconds += times.trace;
    progress_.gatherSeconds += times.gather;
}

void LayerSolver::endDirectRound() {
    Layer& layer = *layers_[work_->layer];
    if (++work_->round < work_->target.directRounds) return order_.begin(input_.patches.chunkCount(), seen_);
    const uint32_t rounds = work_->target.directRounds - layer.directRounds;
    VkCommandBuffer cmd = commands_.begin();
    layerPass_.recordDirect(cmd, input_.light, layer, buffers_.directSums, rounds);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    layer.directRounds = work_->target.directRounds;
    countRays();
    beginBounces();
}

void LayerSolver::countRays() {
    const auto counters = vk::readBuffer<uint32_t>(input_.device, buffers_.rays, shader::kRayCounters);
    progress_.rays = std::accumulate(counters.begin(), counters.end(), progress_.rays);
    VkCommandBuffer cmd = commands_.begin();
    vkCmdFillBuffer(cmd, buffers_.rays.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
}

// Hybrid's first pass is the direct light: with a number of passes the others are gathered over all links.
// Else bounces settle over the links of the first round.
void LayerSolver::beginBounces() {
    const Layer& layer = *layers_[work_->layer];
    work_->bounce = 0;
    if (work_->target.linkRounds == 0) return finishLevel();
    VkCommandBuffer cmd = commands_.begin();
    const VkBufferCopy all{0, 0, input_.light.ligIn.size()};
    vkCmdCopyBuffer(cmd, layer.direct.handle(), input_.light.ligIn.handle(), 1, &all);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    if (settings_.passes > 0) return beginGather();
    beginBounce();
}

void LayerSolver::recordRadiance(VkCommandBuffer cmd) {
    radiancePass_.record(cmd, input_.light, settings_.transport);
    vk::barrier(cmd);
    gatherPass_.recordPack(cmd, input_.light, buffers_);
}

void LayerSolver::beginBounce() {
    work_->stage = Stage::Bounces;
    work_->round = 0;
    VkCommandBuffer cmd = commands_.begin();
    recordRadiance(cmd);
    beginPass(cmd);
}

// What has settled is gathered over the links of all rounds.
void LayerSolver::beginGather() {
    work_->stage = Stage::Gather;
    work_->round = 0;
    VkCommandBuffer cmd = commands_.begin();
    recordRadiance(cmd);
    vkCmdFillBuffer(cmd, buffers_.linkSums.handle(), 0, VK_WHOLE_SIZE, 0);
    beginPass(cmd);
}

void LayerSolver::linkBatch() {
    const Layer& layer = *layers_[work_->layer];
    const uint32_t next = order_.next(1, 0).first;
    const LinkCache::Place place = links_.find(work_->round, next, input_.patches.chunkCount() - next);
    const bool trace = !place.known;
    const ChunkRange range = trace ? nextRange(traceRate_, std::min(place.count, buffers_.batchChunks))
                                   : nextRange(gatherRate_, place.count);
    const auto start = Clock::now();
    const ClosestWork closest{.firstChunk = range.first,
                              .chunkCount = range.count,
                              .firstSample = work_->round * linksOfRound_,
                              .sampleCount = linksOfRound_,
                              .rotation = settings_.links.rotation,
                              .links = place.links,
                              .linksOffset = place.offset};
    const bool bounces = work_->stage == Stage::Bounces;
    const LinkGatherPass::Work work{.links = place.links,
                                    .linksOffset = place.offset,
                                    .samples = linksOfRound_,
                                    .direct = &layer.direct,
                                    .output = bounces,
                                    .accumulate = !bounces,
                                    .range = range};
    if (gatherPass_.onCpu() && !input_.tracer.records())
        linksAtOnce(trace ? &closest : nullptr, work);
    else
        linksBySubmit(trace ? &closest : nullptr, work);
    (trace ? traceRate_ : gatherRate_).note(range.count, batchMs_, secondsSince(start));
    const auto first = senders_.begin() + range.first;
    const uint64_t count = std::accumulate(first, first + range.count, uint64_t{0}) * linksOfRound_;
    (trace ? progress_.rays : progress_.raysSaved) += count;
    progress_.pairs += count;
    links_.note(work_->round, range);
    order_.finish(range);
    if (order_.left() > 0) return;
    if (bounces) return endBounce();
    if (++work_->round < work_->target.linkRounds) return order_.begin(input_.patches.chunkCount(), seen_);
    endGather();
}

// What has settled over few links has their noise, which all links see then: it is gathered again until the
// light has settled over all of them.
void LayerSolver::endGather() {
    ++work_->gathers;
    ++progress_.passes;
    if (work_->target.linkRounds == 1 && settings_.passes == 0) return finishLevel();
    if (settings_.passes > 0 && work_->gathers + 1 >= settings_.passes) return finishLevel();
    std::swap(input_.light.ligIn, input_.light.ligOut);
    VkCommandBuffer cmd = commands_.begin();
    gatherPass_.recordCompose(cmd, input_.light, buffers_, &layers_[work_->layer]->direct,
                              work_->target.linkRounds * linksOfRound_);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    if (settings_.passes == 0 && gathered()) return finishLevel();
    beginGather();
}

// The first change is the noise of what was there before.
bool LayerSolver::gathered() {
    if (work_->gathers == 1) work_->change = 0;
    measureChange();
    return work_->gathers + 1 >= kMaxPasses ||
           (work_->gathers > 1 && work_->iterationError <= iterationAim());
}

// Where the CPU does both, a submit would take longer than a small batch.
void LayerSolver::linksAtOnce(const ClosestWork* closest, const LinkGatherPass::Work& work) {
    const auto start = Clock::now();
    if (closest) input_.tracer.closest(VK_NULL_HANDLE, *closest);
    const double traced = secondsSince(start);
    gatherPass_.record(VK_NULL_HANDLE, input_.light, buffers_, work);
    progress_.traceSeconds += traced;
    progress_.gatherSeconds += secondsSince(start) - traced;
    if (!wantsDistances()) return;
    VkCommandBuffer cmd = commands_.begin();
    gatherPass_.recordDistances(cmd, input_.light, buffers_, work);
    vk::barrier(cmd);
    commands_.run();
}

void LayerSolver::linksBySubmit(const ClosestWork* closest, const LinkGatherPass::Work& work) {
    VkCommandBuffer cmd = commands_.begin();
    timestamps_.reset(cmd);
    timestamps_.mark(cmd, 0);
    const auto start = Clock::now();
    if (closest) input_.tracer.closest(cmd, *closest);
    const double cpuTrace = secondsSince(start);
    vk::barrier(cmd);
    timestamps_.mark(cmd, 1);
    if (gatherPass_.onCpu()) { // which then counts into the time between the same two marks
        vk::hostBarrier(cmd);
        commands_.run();
        cmd = commands_.begin();
    }
    gatherPass_.record(cmd, input_.light, buffers_, work);
    if (wantsDistances()) gatherPass_.recordDistances(cmd, input_.light, buffers_, work);
    timestamps_.mark(cmd, 2);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    progress_.traceSeconds +=
        input_.tracer.onCpu() && closest ? cpuTrace : 1e-3 * timestamps_.milliseconds(0, 1);
    progress_.gatherSeconds += 1e-3 * timestamps_.milliseconds(1, 2);
}

// Of the first round's links: the same for every layer.
bool LayerSolver::wantsDistances() const {
    return buffers_.distances && !distancesKnown_ && work_->stage == Stage::Gather && work_->round == 0;
}

void LayerSolver::endBounce() {
    ++progress_.passes;
    const bool last = settled();
    std::swap(input_.light.ligIn, input_.light.ligOut);
    ++work_->bounce;
    if (last)
        beginGather();
    else
        beginBounce();
}

double LayerSolver::iterationAim() const {
    const double aim = settings_.error > 0 ? kIterationShare * settings_.error : kLeastIterationError;
    const bool first = work_->target == firstLevel() && !(work_->target == lastLevel());
    return first ? std::max(aim, kFirstIterationError) : aim;
}

bool LayerSolver::settled() {
    measureChange();
    return work_->iterationError <= iterationAim() || work_->bounce + 1 >= kMaxPasses;
}

// From ligIn to ligOut or back. The remaining error of a geometric series: change q / (1 - q), q being the
// ratio of the last two changes (conventions.md, Errors). A light that reaches nothing has settled at once.
void LayerSolver::measureChange() {
    VkCommandBuffer cmd = commands_.begin();
    resolvePass_.recordChange(cmd, input_.light, buffers_);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    glm::dvec4 total(0.0);
    for (const glm::vec4& sum :
         vk::readBuffer<glm::vec4>(input_.device, buffers_.chunkSums, input_.patches.chunkCount()))
        total += glm::dvec4(sum);
    const double change = total.z > 0 ? std::sqrt(total.x / (3.0 * total.z)) : 0.0;
    const double mean = total.z > 0 ? total.y / (3.0 * total.z) : 0.0;
    Work& work = *work_;
    if (change == 0.0 || mean <= 0.0) {
        work.iterationError = work.ratio = 0.0;
    } else if (work.change > 0.0) {
        work.ratio = change / work.change;
        work.iterationError = work.ratio < 1.0 ? change * work.ratio / (1.0 - work.ratio) / mean : 1.0;
    }
    work.change = change;
}

void LayerSolver::abortPass() {
    if (!work_) return;
    if (work_->stage == Stage::Direct) countRays();
    work_.reset();
    progress_.passFraction = 0;
}

void LayerSolver::setPriority(std::vector<uint8_t> chunkSeen) {
    ASSERT(chunkSeen.empty() || chunkSeen.size() == input_.patches.chunkCount());
    seen_ = std::move(chunkSeen);
    if (work_) order_.prefer(seen_);
}

} // namespace relume
