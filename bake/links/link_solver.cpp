#include "bake/links/link_solver.h"

#include "bake/base/series.h"
#include "bake/direct/point_trace.h"
#include "bake/links/directions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace relume {
namespace {

using shader::kChunk;

// A submit interpolates so many chunks: 0.26M patches take about 20 ms on two cores.
constexpr uint32_t kInterpolatedChunks = 4096;

EmitterLight makeEmitters(const SolverInput& input, bool hybrid, uint32_t links) {
    const PatchSet& patches = input.patches;
    EmitterLight light(input.device, patches, links);
    light.setGroups({hybrid ? buildEmitters(input.scene, patches.scene.mesh, {.size = patches.scene.size})
                            : EmitterSet{}});
    return light;
}

} // namespace

LinkSolver::LinkSolver(const SolverInput& input, const SolverSettings& settings)
    : input_(input), settings_(settings), hybrid_(settings.method == Method::Hybrid),
      linksOfRound_(
          relume::linksOfRound(input.patches.count, settings.links.samples, input.device.info().software())),
      emitters_(makeEmitters(input, hybrid_, linksOfRound_)),
      lamps_(input.device, input.scene, input.patches, {.samples = linksOfRound_}),
      coarse_(settings.links.indirectScale > 1
                  ? buildCoarsePatches(input.patches, settings.links.indirectScale)
                  : CoarsePatches{}),
      buffers_(input.device, input.patches,
               {.linksOfRound = linksOfRound_,
                .direct = hasDirect(),
                .smooth = hybrid_ && settings.links.smooth,
                .coarse = coarse_.count > 0 ? &coarse_ : nullptr,
                .linkBytes = settings.cache.keepsLinks() ? settings.cache.bytes : 0}),
      radiancePass_(input.device), gatherPass_(input.device, settings.transport), resolvePass_(input.device),
      commands_(input.device), timestamps_(input.device, 3),
      order_(std::max(input.patches.chunkCount(), coarse_.chunkCount())) {
    batchMs_ = settings.batchMs;
    settings_.transport.reflectedOnly = hybrid_;
    const PatchSet& patches = input.patches;
    if (settings.links.footprint) {
        footprints_.emplace(input.device, patches);
        input.light.radiance = footprints_->makeRadiance(input.device);
    } else if (input.light.radiance.size() != LightBuffers::lightBytes(patches)) { // another solver's nodes
        input.light.radiance =
            vk::Buffer(input.device, {.size = LightBuffers::lightBytes(patches), .name = "radiance"});
    }
    if (!gatherPass_.onCpu())
        buffers_.packed = vk::Buffer(
            input.device, {.size = input.light.radiance.size() / sizeof(glm::vec4) * sizeof(glm::uvec2),
                           .name = "packed radiance"});
    const std::vector<shader::Patch>& receivers =
        coarse_.count > 0 ? coarse_.receivers : patches.scene.patches;
    senders_.assign(receivers.size() / kChunk, 0);
    for (size_t i = 0; i < receivers.size(); ++i)
        senders_[i / kChunk] += (receivers[i].flags & shader::kPatchSends) != 0;

    if (settings.links.directions == DirectionSet::Lec) makeDisc();
    VkCommandBuffer cmd = commands_.begin();
    for (const vk::Buffer* buffer :
         {&buffers_.linkSums, &buffers_.directSums, &buffers_.direct, &buffers_.rays, &buffers_.result,
          &input.light.ligIn, &input.light.ligOut}) {
        if (*buffer) vkCmdFillBuffer(cmd, buffer->handle(), 0, VK_WHOLE_SIZE, 0);
    }
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    light_.assign(patches.scene.patches.size(), glm::vec4(0.0f));
    if (settings.live && !buffers_.rows)
        undo_ = vk::Buffer(input.device, {.size = buffers_.linkSums.size(), .name = "sums before the round"});
    const uint64_t kept = uint64_t{buffers_.keptChunks} * linksOfRound_ * kChunk * sizeof(uint32_t);
    progress_.cacheBytes = kept;
    traced_.assign(buffers_.keptChunks, 0);
    progress_.cachedShare = static_cast<double>(buffers_.keptChunks) / static_cast<double>(senders_.size());
}

// Makes the directions' set. Each replicate goes through it once; where the error decides how many sample
// passes there will be, once per sample pass: a set that is broken off is less even.
void LinkSolver::makeDisc() {
    const uint32_t rounds = settings_.links.samples > 0 ? roundsWanted() : 1;
    discCount_ = rounds * linksOfRound_ / shader::kReplicates;
    std::vector<glm::vec2> points;
    points.reserve(discCount_);
    for (const glm::dvec2 p : evenRings(largestEmptyCircleDisc(discCount_)))
        points.emplace_back(p);
    disc_ = vk::makeBuffer(input_.device, points, "directions");
}

void LinkSolver::step() {
    if (done_) return;
    const auto start = Clock::now();
    if (state_.stage == Stage::Plan) plan();
    if (state_.stage == Stage::Direct)
        directBatch();
    else if (state_.stage == Stage::Links)
        linkBatch();
    progress_.passFraction = 1.0 - static_cast<double>(order_.left()) / std::max(1u, order_.count());
    progress_.seconds += secondsSince(start);
}

// Plans direct light first, then links; then whichever takes more of the error away for its rays.
void LinkSolver::plan() {
    const uint32_t rounds = state_.directRounds + state_.linkRounds;
    // With a number of samples alone, errors decide nothing.
    if (settings_.error > 0 && rounds > 0 && rounds >= state_.nextCheck) check();
    if (progress_.converged || gridLimits_ || enoughRounds()) {
        if (stale_) resolve();
        done_ = true;
        return;
    }
    if (settings_.live) look();
    begin(wantsDirect() ? Stage::Direct : Stage::Links);
}

void LinkSolver::begin(Stage stage) {
    state_.stage = stage;
    state_.bounce = 0;
    if (stage == Stage::Links) {
        std::fill(traced_.begin(), traced_.end(), uint8_t{0});
        beginBounce();
    } else {
        order_.begin(chunksOfStage(), seenOfStage());
        VkCommandBuffer cmd = commands_.begin();
        vkCmdFillBuffer(cmd, buffers_.rays.handle(), 0, VK_WHOLE_SIZE, 0);
        recordUndo(cmd);
        vk::barrier(cmd);
        commands_.run();
    }
}

uint32_t LinkSolver::roundsWanted() const {
    const uint32_t limit = settings_.links.samples > 0 ? settings_.links.samples : kMaxSamples;
    return (limit + linksOfRound_ - 1) / linksOfRound_;
}

// Returns how many directions share the result. Each direction stands for its share of the whole result.
// Where the error decides how many there will be, it is that of what is there so far: the mean over sample
// passes of something that falls as 1 / rounds falls to nothing, too.
uint32_t LinkSolver::footprintSamples() const {
    return linksOfRound_ * (settings_.links.samples > 0 ? roundsWanted() : state_.linkRounds + 1);
}

bool LinkSolver::linksDone() const {
    return state_.linkRounds >= roundsWanted() || (hybrid_ && settings_.passes == 1);
}

bool LinkSolver::directDone() const {
    return !hasDirect() || state_.directRounds >= roundsWanted();
}

bool LinkSolver::enoughRounds() const {
    return linksDone() && directDone();
}

bool LinkSolver::wantsDirect() const {
    if (directDone()) return false;
    if (state_.directRounds == 0 || linksDone()) return true;
    if (state_.linkRounds == 0) return false;
    if (settings_.links.samples > 0) return state_.directRounds <= state_.linkRounds;
    const double linkShare = static_cast<double>(senders_.size()) / input_.patches.chunkCount();
    // Variance falls as 1 / rounds at least; this is what one more takes away, for its cost.
    const auto gain = [](double variance, double then, double now, double cost) {
        return variance * then / (now * now * cost);
    };
    return gain(state_.directVariance, state_.directAtCheck, state_.directRounds,
                kSegmentCost * (emitters_.rays(0) + lamps_.rays())) >
           gain(state_.indirectVariance, state_.linksAtCheck, state_.linkRounds, linksOfRound_ * linkShare);
}

ChunkRange LinkSolver::nextRange(const BatchRate& rate, uint32_t most) const {
    const double limit = std::clamp(rate.wanted(batchMs_), 1.0, std::max(1.0, static_cast<double>(most)));
    return order_.next(static_cast<uint32_t>(limit), static_cast<uint32_t>(rate.perMs() * kWorthASubmit));
}

const std::vector<uint8_t>& LinkSolver::seenOfStage() const {
    return state_.stage == Stage::Links && coarse_.count > 0 ? seenReceivers_ : seenPatches_;
}

// Direct light is every patch's own; links may start at fewer.
uint32_t LinkSolver::chunksOfStage() const {
    return state_.stage == Stage::Links ? static_cast<uint32_t>(senders_.size())
                                        : input_.patches.chunkCount();
}

void LinkSolver::directBatch() {
    const uint32_t batch = std::min(buffers_.batchChunks, emitters_.batchChunks());
    const uint32_t most = lamps_.empty() ? batch : std::min(batch, lamps_.batchChunks());
    const ChunkRange range = nextRange(directRate_, most);
    const auto start = Clock::now();
    const PointTracer on{commands_, timestamps_, input_.tracer};
    const auto note = [&](const PointTimes& times) {
        progress_.traceSeconds += times.trace;
        progress_.gatherSeconds += times.gather;
    };
    if (emitters_.rays(0) > 0) {
        const EmitterLight::Work work{.group = 0, .round = state_.directRounds, .range = range};
        const auto samples = [&](VkCommandBuffer cmd) { emitters_.recordSamples(cmd, input_.light, work); };
        note(tracePoints(on, emitters_.segments(work, buffers_.rays), samples, [&](VkCommandBuffer cmd) {
            emitters_.recordGather(cmd, input_.light, work, buffers_.directSums, buffers_.direct);
        }));
    }
    for (uint32_t group = 0; group < lamps_.groups(); ++group) {
        const LampLight::Work work{.group = group, .round = state_.directRounds, .range = range};
        const auto samples = [&](VkCommandBuffer cmd) { lamps_.recordSamples(cmd, input_.light, work); };
        note(tracePoints(on, lamps_.segments(work, buffers_.rays), samples, [&](VkCommandBuffer cmd) {
            lamps_.recordGather(cmd, input_.light, work, buffers_.directSums, buffers_.direct);
        }));
    }
    directRate_.note(range.count, batchMs_, secondsSince(start));
    order_.finish(range);
    if (settings_.live && !hasSolution()) live_.ranges.push_back(range);
    if (order_.left() > 0) return;
    const auto counters = vk::readBuffer<uint32_t>(input_.device, buffers_.rays, shader::kRayCounters);
    progress_.rays = std::accumulate(counters.begin(), counters.end(), progress_.rays);
    ++state_.directRounds;
    stale_ = true;
    state_.stage = Stage::Plan;
}

// Makes what links read: radiance of patches and, where they have footprints, of nodes.
void LinkSolver::recordRadiance(VkCommandBuffer cmd) {
    radiancePass_.record(cmd, input_.light, settings_.transport);
    if (footprints_) {
        vk::barrier(cmd);
        footprints_->recordLevels(cmd, input_.light.radiance);
    }
    vk::barrier(cmd);
    gatherPass_.recordPack(cmd, input_.light, buffers_);
}

void LinkSolver::beginBounce() {
    const bool counted = settings_.passes > 0;
    // Hybrid's first pass is its direct light.
    const uint32_t bounces = hybrid_ ? settings_.passes - 1 : settings_.passes;
    if (counted)
        state_.last = state_.bounce + 1 >= bounces;
    else if (state_.linkRounds > 0)
        state_.last = true;
    else if (state_.bounce == 0)
        state_.last = false;
    VkCommandBuffer cmd = commands_.begin();
    if (state_.last) recordUndo(cmd);
    if (state_.bounce == 0) {
        const uint32_t samples = counted ? 0 : state_.linkRounds * linksOfRound_;
        gatherPass_.recordCompose(cmd, input_.light, buffers_, hasDirect() ? &buffers_.direct : nullptr,
                                  samples);
        vk::barrier(cmd);
    }
    recordRadiance(cmd);
    if (buffers_.coarseSums) vkCmdFillBuffer(cmd, buffers_.coarseSums.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    order_.begin(chunksOfStage(), seenOfStage());
    if (!hasSolution()) {
        live_.all = true;
        live_.ranges.clear();
    }
}

void LinkSolver::linkBatch() {
    // Mostly links are there from the sample pass's second bounce on; after a restore they are traced once
    // more.
    const uint32_t next = order_.next(1, 0).first;
    const bool kept = next < buffers_.keptChunks;
    const auto known = traced_.begin() + std::min(next, buffers_.keptChunks);
    const bool trace = !kept || *known == 0;
    const auto alike = static_cast<uint32_t>(std::find(known, traced_.end(), trace ? 1 : 0) - known);
    const uint32_t room = kept ? alike : buffers_.batchChunks;
    const ChunkRange range =
        trace ? nextRange(traceRate_, std::min(room, buffers_.batchChunks)) : nextRange(gatherRate_, room);
    const uint64_t offset = kept ? uint64_t{range.first} * linksOfRound_ * kChunk : 0; // [words]
    const vk::Buffer& links = kept ? buffers_.links : buffers_.linksStaging;
    const auto start = Clock::now();
    const ClosestWork closest{.receivers = coarse_.count > 0 ? &buffers_.receivers : nullptr,
                              .receiversHost = coarse_.count > 0 ? coarse_.receivers.data() : nullptr,
                              .firstChunk = range.first,
                              .chunkCount = range.count,
                              .firstSample = state_.linkRounds * linksOfRound_,
                              .sampleCount = linksOfRound_,
                              .rotation = settings_.links.rotation,
                              .disc = disc_ ? &disc_ : nullptr,
                              .discCount = discCount_,
                              .links = &links,
                              .linksOffset = offset};
    const LinkGatherPass::Work work{.links = &links,
                                    .linksOffset = offset,
                                    .nodes = footprints_ ? footprints_->nodes() : 0,
                                    .samples = linksOfRound_,
                                    .direct = hasDirect() ? &buffers_.direct : nullptr,
                                    .accumulate = state_.last,
                                    .range = range};
    if (gatherPass_.onCpu() && !input_.tracer.records() && !footprints_)
        linksAtOnce(trace ? &closest : nullptr, work);
    else
        linksBySubmit(trace ? &closest : nullptr, work);
    (trace ? traceRate_ : gatherRate_).note(range.count, batchMs_, secondsSince(start));
    const auto first = senders_.begin() + range.first;
    const uint64_t count = std::accumulate(first, first + range.count, uint64_t{0}) * linksOfRound_;
    (trace ? progress_.rays : progress_.raysSaved) += count;
    if (kept) std::fill_n(known, range.count, uint8_t{1});
    progress_.pairs += count;
    order_.finish(range);
    if (settings_.live && !hasSolution() && coarse_.count == 0) live_.ranges.push_back(range);
    if (order_.left() == 0) endBounce();
}

// Traces and gathers without a submit, which would take longer than a small batch where the CPU does both.
void LinkSolver::linksAtOnce(const ClosestWork* closest, const LinkGatherPass::Work& work) {
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

void LinkSolver::linksBySubmit(const ClosestWork* closest, const LinkGatherPass::Work& work) {
    VkCommandBuffer cmd = commands_.begin();
    timestamps_.reset(cmd);
    timestamps_.mark(cmd, 0);
    const auto start = Clock::now();
    if (closest) input_.tracer.closest(cmd, *closest);
    const double cpuTrace = secondsSince(start);
    vk::barrier(cmd);
    timestamps_.mark(cmd, 1);
    if (closest && footprints_) {
        const vk::Buffer& receivers = coarse_.count > 0 ? buffers_.receivers : input_.light.patches;
        footprints_->recordLinks(cmd, input_.light.patches.address(),
                                 {.receivers = receivers.address(),
                                  .links = work.address(),
                                  .firstChunk = work.range.first,
                                  .chunkCount = work.range.count,
                                  .sampleCount = linksOfRound_,
                                  .samples = footprintSamples()});
        vk::barrier(cmd);
    }
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

// Interpolates from the receivers of the coarser grid to all patches.
void LinkSolver::interpolate() {
    const uint32_t chunks = input_.patches.chunkCount();
    const bool distances = buffers_.distances && state_.linkRounds == 0 && state_.last;
    for (uint32_t first = 0; first < chunks; first += kInterpolatedChunks) {
        VkCommandBuffer cmd = commands_.begin();
        gatherPass_.recordInterpolate(cmd, input_.light, buffers_,
                                      {.samples = linksOfRound_,
                                       .direct = hasDirect() ? &buffers_.direct : nullptr,
                                       .accumulate = state_.last,
                                       .distances = distances,
                                       .range = {first, std::min(kInterpolatedChunks, chunks - first)}});
        vk::barrier(cmd);
        commands_.run();
    }
}

void LinkSolver::endBounce() {
    if (coarse_.count > 0) interpolate();
    ++progress_.passes;
    const bool settling = settings_.passes == 0 && state_.linkRounds == 0 && !state_.last;
    if (settling) measureChange();
    std::swap(input_.light.ligIn, input_.light.ligOut);
    ++state_.bounce;
    if (!state_.last) {
        const double aim = settings_.error > 0 ? kIterationShare * settings_.error : kLeastIterationError;
        if (settling) state_.last = state_.iterationError <= aim || state_.bounce + 1 >= kMaxPasses;
        return beginBounce();
    }
    if (settings_.passes == 0) {
        state_.iterationError *= state_.ratio; // this bounce's own share
        if (state_.linkRounds == 0)
            state_.settling.bounce();
        else
            state_.settling.round(state_.linkRounds);
    } else
        state_.iterationError = 0; // what more bounces would add is not asked for
    ++state_.linkRounds;
    progress_.samples = state_.linkRounds * linksOfRound_;
    stale_ = true;
    state_.stage = Stage::Plan;
}

void LinkSolver::measureChange() {
    VkCommandBuffer cmd = commands_.begin();
    resolvePass_.recordChange(cmd, input_.light, buffers_);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    const glm::dvec4 total =
        sumsOf(vk::readBuffer<glm::vec4>(input_.device, buffers_.chunkSums, input_.patches.chunkCount()));
    const double change = total.z > 0 ? std::sqrt(total.x / (3.0 * total.z)) : 0.0;
    const double mean = total.z > 0 ? total.y / (3.0 * total.z) : 0.0;
    if (state_.bounce == 0) state_.settling.add(total.w / std::max(1.0, 3.0 * total.z));
    state_.settling.add(mean);
    if (const std::optional<SeriesRest> rest = seriesRest(state_.change, change, mean)) {
        state_.ratio = rest->ratio;
        state_.iterationError = rest->error;
    }
    state_.change = change;
}

SolverState LinkSolver::state() {
    ASSERT(!done_);
    return makeState(state_);
}

std::vector<StatePart> LinkSolver::stateParts() {
    std::vector<StatePart> parts;
    for (const vk::Buffer* buffer :
         {&input_.light.ligIn, &input_.light.ligOut, &buffers_.linkSums, &buffers_.directSums,
          &buffers_.direct, &buffers_.distances, &buffers_.coarseSums, &buffers_.rays}) {
        if (*buffer) parts.push_back(part(input_.device, *buffer));
    }
    parts.push_back(part(order_));
    return parts;
}

void LinkSolver::restore(const SolverState& state) {
    state_ = takeState<State>(state);
    order_.restore(chunksOfStage(), seenOfStage());
    done_ = false;
    stale_ = true;
    live_ = {.version = live_.version};
    std::fill(traced_.begin(), traced_.end(), uint8_t{0});
    if (state_.stage != Stage::Links) return;
    VkCommandBuffer cmd = commands_.begin();
    recordRadiance(cmd);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
}

uint64_t LinkSolver::bytes(uint32_t chunkCount, bool software, const SolverSettings& settings) {
    const uint64_t patches = uint64_t{chunkCount} * shader::kChunk;
    return LinkBuffers::bytes(chunkCount, software, settings) +
           (settings.links.footprint ? Footprints::bytes(patches) : 0);
}

} // namespace relume
