// This part of LinkSolver is about its result, how far that is off, what comes next for it, its state, and
// what a viewer asks.
#include "bake/links/link_solver.h"

#include "assets/base/error.h"
#include "bake/base/finite_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;

// Results are made for the viewer's eyes at most as often as a display shows them, and so that they take no
// more than this share of the time.
constexpr double kLookSeconds = 1.0 / 60.0, kLookShare = 0.1;

// Where the grid alone misses the error that was asked for, sampling ends when it adds this little to the
// square.
constexpr double kBesideGrid = 0.1;

// A plan that asks for nothing more though the error is not there yet is made for so much less error, so many
// times at most.
constexpr double kStricter = 0.8;
constexpr uint32_t kMostStricter = 32;

// Returns the state's buffers of which each rank has its own chunks.
std::vector<RankChunks::Shared> ownBuffers(const LinkKit& kit) {
    const LightBuffers& light = kit.input.light;
    const LinkBuffers& buffers = kit.buffers;
    constexpr VkDeviceSize kLight = kChunk * sizeof(glm::vec4);
    return {{light.ligIn, kLight},
            {light.ligOut, kLight},
            {buffers.linkSums, kLight, shader::kReplicates},
            {buffers.directSums, kLight, shader::kReplicates},
            {buffers.direct, kLight},
            {buffers.carried, kLight},
            {buffers.notes, sizeof(glm::uvec2)},
            {buffers.distances, kChunk * sizeof(glm::vec2)}};
}

} // namespace

// Plans direct light first, then links; then whichever takes more of the error away for its rays, or chunk by
// chunk.
void LinkSolver::plan() {
    const bool pending = directSamplePasses_.pending() || linkSamplePasses_.pending();
    if (!pending) {
        // With a number of samples alone, errors decide nothing.
        if (schedule_.wantsCheck(state_)) check();
        const bool planned = !progress_.converged && !gridLimits_ &&
                             (state_.scaled || !schedule_.isDone(state_)) && planChunks();
        if (!planned) {
            if (stale_) resolve();
            done_ = true;
            return;
        }
    }
    if (kit_.settings.live) look();
    begin(directSamplePasses_.pending() ? Stage::Direct : Stage::Links);
}

// Makes chunks want more sample passes, and tells whether any does.
bool LinkSolver::planChunks() {
    if (!state_.scaled) {
        if (state_.apart.on && schedule_.plansDirect(state_)) {
            state_.apart.planned = state_.linkSamplePasses;
            directSamplePasses_.want(
                directPlan_.wanted(schedule_.directRules(state_), directSamplePasses_.done()));
        }
        if (!directSamplePasses_.pending())
            samplePassesOf(schedule_.wantsDirect(state_) ? Stage::Direct : Stage::Links).wantOneMore();
        return true;
    }
    const std::vector<ChunkVariance> chunks = errors_.chunks();
    const std::span<const uint32_t> direct = directSamplePasses_.done(), links = linkSamplePasses_.done();
    const ChunkPlan now{{direct.begin(), direct.end()}, {links.begin(), links.end()}};
    ChunkPlan plan = now;
    for (uint32_t tries = 0; tries < kMostStricter && plan == now; ++tries) {
        if (tries > 0) state_.strictness *= kStricter;
        plan = relume::planChunks(schedule_.planRules(state_), chunks, now);
    }
    directSamplePasses_.want(plan.direct);
    linkSamplePasses_.want(plan.links);
    return plan != now;
}

void LinkSolver::uploadScales() {
    const auto scale = [](double samples) { return static_cast<float>(samples > 0 ? 1.0 / samples : 0.0); };
    const double perReplicate = static_cast<double>(kit_.linksOfSamplePass) / shader::kReplicates;
    std::vector<glm::vec2> scales;
    for (size_t i = 0; i < linkSamplePasses_.done().size(); ++i)
        scales.emplace_back(scale(perReplicate * linkSamplePasses_.done()[i]),
                            scale(directSamplePasses_.done()[i]));
    vk::upload(kit_.input.device, kit_.buffers.scales, scales.data(), scales.size() * sizeof(glm::vec2));
}

// Finds the error that is left, from what the replicates say and the iteration; keeps it in progress().
void LinkSolver::check() {
    state_.nextCheck = state_.samplePasses() + 1;
    if (!schedule_.hasSolution(state_)) return; // no bounces yet
    resolve();
    const double aim = kit_.settings.error;
    const double excess = schedule_.excess(progress_.error, progress_.localError95);
    progress_.converged = excess <= 1.0;
    if (schedule_.plansApart() && !schedule_.perChunk()) {
        const std::span<const uint32_t> done = directSamplePasses_.done();
        const bool locally = schedule_.choosesLocally(progress_.error, progress_.localError95);
        directPlan_.learn(errors_.chunks(), done, locally);
        const LinkSchedule::PlannedApart planned =
            schedule_.apart(state_, directPlan_, done, excess, progress_.localError95);
        state_.apart = planned.apart;
        directSamplePasses_.want(planned.wanted);
    }
    state_.nextCheck = schedule_.perChunk() ? 0 : schedule_.nextCheck(state_, excess);
    state_.scaled = schedule_.perChunk();
    if (state_.scaled) uploadScales();
    // No number of samples makes up for a grid that is too coarse.
    const double grid2 = progress_.gridError * progress_.gridError;
    gridLimits_ = aim > 0 && progress_.gridError > aim &&
                  progress_.error * progress_.error - grid2 <= kBesideGrid * grid2;
}

void LinkSolver::resolve() {
    kit_.shareCounters();
    if (kit_.buffers.rows) { // smoothing reads what is near, of other ranks, too
        kit_.rankChunks.shareNear({kit_.buffers.linkSums, kChunk * sizeof(glm::vec4), shader::kReplicates});
        kit_.rankChunks.shareNear({kit_.buffers.distances, kChunk * sizeof(glm::vec2)});
    }
    if (state_.apart.on) uploadScales();
    const auto at = [this](double sigma) { return errors_.resolve(state_, sigma); };
    const bool isNew = state_.median == 0;
    shader::ResolveSums sums = kit_.buffers.rows ? state_.width.converge(at) : at(0.0);
    LinkErrors::Local local = errors_.local();
    state_.median = local.median;
    // What local error is relative to hangs on the median, which hardly changes once it is known.
    if (isNew && state_.median > 0) {
        sums = at(kit_.buffers.rows ? state_.width.sigma : 0.0);
        local = errors_.local();
    }
    learn(sums, local);
    stale_ = false;
    light_.clear();
}

// Learns what sums over all patches say, and that there is a new result.
void LinkSolver::learn(const shader::ResolveSums& sums, const LinkErrors::Local& local) {
    requireFiniteLight(sums.light, double(sums.direct) + sums.raw + sums.indirect);
    state_.directVariance = sums.direct;
    state_.indirectVariance = smoothedVariance(sums);
    state_.light = sums.light;
    state_.patches = sums.count;
    state_.bias = std::max(0.0f, sums.bias);
    progress_.localError95 = local.error.p95;
    progress_.localError99 = local.error.p99;
    state_.directAtCheck = state_.directSamplePasses;
    state_.linksAtCheck = state_.linkSamplePasses;
    progress_.error = 0;
    if (sums.light > 0) {
        state_.coarseVariance = errors_.coarseVariance(state_, sums.count);
        progress_.gridError = relativeError({sums.light, sums.count, state_.coarseVariance}, 0.0);
        const double variance = state_.directVariance + state_.indirectVariance + state_.coarseVariance;
        const double iteration = schedule_.directAlone() ? 0.0 : state_.series.error;
        progress_.error = relativeError({sums.light, sums.count, variance}, iteration);
    }
    const bool locally = schedule_.choosesLocally(progress_.error, progress_.localError95);
    state_.directChoice = locally ? local.direct : state_.directVariance;
    state_.linkChoice = locally ? local.links : state_.indirectVariance;
    if (!schedule_.hasSolution(state_)) {
        live_.all = true; // this result is without what has arrived since
        return;
    }
    ++live_.resolves;
    live_.complete = live_.complete || kit_.settings.passes > 0 || state_.convergence.left <= kMostDimmer;
}

// Returns the light so far; within a sample pass only some patches have its samples. What a look teaches
// about widths and variances must not decide what comes next: looking changes no byte.
const std::vector<glm::vec4>& LinkSolver::light() {
    if (stale_ && state_.stage == Stage::Plan && state_.samplePasses() > 0) {
        const LinkState before = state_;
        resolve();
        state_ = before;
    }
    const size_t count = kit_.input.patches.scene.patches.size();
    if (light_.empty() && state_.samplePasses() == 0) light_.assign(count, glm::vec4(0.0f));
    if (light_.empty()) {
        kit_.rankChunks.share({kit_.buffers.result, kChunk * sizeof(glm::vec4)});
        light_ = vk::readBuffer<glm::vec4>(kit_.input.device, kit_.buffers.result, count);
    }
    return light_;
}

std::vector<float> LinkSolver::errors() {
    std::vector<float> result;
    for (const glm::vec4& v : light())
        result.push_back(v.w);
    return result;
}

SolverState LinkSolver::state() {
    ASSERT(!done_);
    return makeState(state_);
}

void LinkSolver::collect() {
    if (kit_.rankChunks.alone()) return;
    ASSERT(passBoundary());
    kit_.shareCounters();
    for (const RankChunks::Shared& shared : ownBuffers(kit_))
        if (shared.buffer) kit_.rankChunks.share(shared);
}

std::vector<StatePart> LinkSolver::stateParts() {
    const LinkBuffers& buffers = kit_.buffers;
    std::vector<StatePart> parts;
    const auto add = [&](const vk::Buffer& buffer) {
        if (buffer) parts.push_back(part(kit_.input.device, buffer));
    };
    for (const RankChunks::Shared& shared : ownBuffers(kit_))
        add(shared.buffer);
    add(buffers.coarseSums);
    add(buffers.rays);
    parts.push_back(part(kit_.order));
    for (ChunkSamplePasses* samplePasses : {&directSamplePasses_, &linkSamplePasses_}) {
        parts.push_back(part(samplePasses->doneArray()));
        parts.push_back(part(samplePasses->wantedArray()));
    }
    parts.push_back(part(directPlan_.ofOneArray()));
    parts.push_back(part(directPlan_.patchesArray()));
    return parts;
}

void LinkSolver::restore(const SolverState& state) {
    state_ = takeState<LinkState>(state);
    if (state_.stage != Stage::Plan) pass_ = samplePassesOf(state_.stage).next(state_.passSamplePasses);
    if (state_.scaled) uploadScales();
    if (!kit_.rankChunks.alone()) { // what is left of the pass under way, and what it has counted, is shared
        kit_.order.marks() = kit_.rankChunks.ownOf(kit_.order.marks());
        if (!kit_.input.ranks.speaks()) {
            VkCommandBuffer cmd = kit_.commands.begin();
            vkCmdFillBuffer(cmd, kit_.buffers.rays.handle(), 0, VK_WHOLE_SIZE, 0);
            kit_.run(cmd);
        }
    }
    kit_.order.restore(chunksOfStage(), seenOfStage());
    kit_.noteCounters();
    done_ = false;
    stale_ = true;
    live_ = {.version = live_.version};
    batches_.cache().forget();
    if (state_.stage != Stage::Links) return;
    VkCommandBuffer cmd = kit_.commands.begin();
    recordRadiance(cmd);
    kit_.run(cmd);
    shareRadiance();
}

// A coarser grid's chunk is seen when light of one of its receivers goes into a patch that is.
void LinkSolver::setPriority(std::vector<uint8_t> chunkSeen) {
    ASSERT(chunkSeen.empty() || chunkSeen.size() == kit_.input.patches.chunkCount());
    kit_.seen = std::move(chunkSeen);
    seenReceivers_.assign(kit_.seen.empty() ? 0 : coarse_.chunkCount(), 0);
    const std::vector<shader::CoarseTaps>& taps = coarse_.taps;
    for (size_t i = 0; i < taps.size() && !kit_.seen.empty(); ++i) {
        if (kit_.seen[i / kChunk] == 0) continue;
        const shader::CoarseTaps& t = taps[i];
        const glm::uvec4 receivers(t.receiver0, t.receiver1, t.receiver2, t.receiver3);
        for (int k = 0; k < 4; ++k)
            if (t.weights[k] != 0.0f) seenReceivers_[receivers[k] / kChunk] = 1;
    }
    if (state_.stage != Stage::Plan) kit_.order.prefer(seenOfStage());
}

// Makes a sample pass's result at its end, where a viewer waits for one and there is time. It does so once:
// the width of smoothing is what the look before said. light() and the end make theirs anew.
void LinkSolver::look() {
    const uint32_t samplePasses = state_.samplePasses();
    if (!stale_ || !schedule_.hasSolution(state_) || !live_.asked || samplePasses == live_.samplePasses)
        return;
    const double pause = std::max(kLookSeconds, live_.cost / kLookShare);
    if (live_.resolves > 0 && secondsSince(live_.looked) < pause) return;
    live_.looked = Clock::now();
    const LinkState before = state_;
    SmoothingWidth width = live_.width.value_or(state_.width);
    if (state_.apart.on) uploadScales();
    const shader::ResolveSums sums = errors_.resolve(state_, kit_.buffers.rows ? width.sigma : 0.0);
    learn(sums, errors_.local());
    if (kit_.buffers.rows) width.adapt(sums);
    live_.width = width;
    state_ = before;
    live_.cost = secondsSince(live_.looked);
    live_.samplePasses = samplePasses;
    live_.asked = false;
    light_.clear(); // within the next sample pass this is the latest there is
}

LiveLight LinkSolver::liveLight() {
    ASSERT(kit_.settings.live);
    if (passBoundary()) look();
    live_.asked = true;
    std::vector<ChunkRange> changed;
    if (live_.resolves == 0)
        changed = showUnfinished();
    else if (live_.resolves != live_.shown)
        changed = {{0, kit_.input.patches.chunkCount()}};
    live_.shown = live_.resolves;
    if (!changed.empty()) ++live_.version;
    const bool seenLit = !seenOfStage().empty() && !kit_.order.prefersSome();
    live_.lit = live_.lit || done_ || schedule_.hasFirstLight(state_, seenLit);
    return {.light = live_.lit ? &kit_.buffers.result : nullptr,
            .version = live_.version,
            .complete = live_.complete || done_,
            .changed = std::move(changed)};
}

// Shows the light that bounces on and, where the bounce under way has been, the light of that one. After a
// restore within a sample pass this is all that can be shown: sums are of different sample passes.
std::vector<ChunkRange> LinkSolver::showUnfinished() {
    std::vector<ChunkRange> ranges = merged(std::exchange(live_.ranges, {}));
    if (!live_.all && ranges.empty()) return {};
    const LightBuffers& light = kit_.input.light;
    const bool inLinks = state_.stage == Stage::Links;
    const std::vector<ChunkRange> all = {{0, kit_.input.patches.chunkCount()}};
    VkCommandBuffer cmd = kit_.commands.begin();
    if (live_.all) {
        const bool bounces = inLinks || schedule_.hasSolution(state_) || !hasDirect();
        recordCopy(cmd, bounces ? light.ligIn : kit_.buffers.direct, kit_.buffers.result, all);
        vk::barrier(cmd);
    }
    recordCopy(cmd, inLinks ? light.ligOut : kit_.buffers.direct, kit_.buffers.result, ranges);
    vk::barrier(cmd);
    kit_.commands.run();
    return std::exchange(live_.all, false) ? all : ranges;
}

const vk::Buffer& LinkSolver::sumsOfStage() const {
    return state_.stage == Stage::Direct ? kit_.buffers.directSums : kit_.buffers.linkSums;
}

// Keeps the sums in what smoothing is made with, which lies idle within a sample pass. With a coarser grid,
// links add to sums only when all of them are there.
void LinkSolver::recordUndo(VkCommandBuffer cmd) {
    live_.undoable = kit_.settings.live;
    if (!kit_.settings.live || (state_.stage == Stage::Links && coarse_.count > 0)) return;
    const vk::Buffer& sums = sumsOfStage();
    const VkBufferCopy all{0, 0, sums.size()};
    vkCmdCopyBuffer(cmd, sums.handle(), (undo_ ? undo_ : kit_.buffers.rows).handle(), 1, &all);
}

void LinkSolver::undo() {
    const vk::Buffer& sums = sumsOfStage();
    const VkBufferCopy all{0, 0, sums.size()};
    VkCommandBuffer cmd = kit_.commands.begin();
    vkCmdCopyBuffer(cmd, (undo_ ? undo_ : kit_.buffers.rows).handle(), sums.handle(), 1, &all);
    vk::barrier(cmd);
    if (state_.stage == Stage::Direct) {
        if (state_.apart.on) uploadScales();
        kit_.gatherPass.recordDirectMean(cmd, kit_.input.light, kit_.buffers, state_.directSamplePasses,
                                         scales());
        vk::barrier(cmd);
    }
    vk::hostBarrier(cmd);
    kit_.commands.run();
}

void LinkSolver::abortPass() {
    if (passBoundary()) return;
    const bool direct = state_.stage == Stage::Direct;
    const bool adds = direct || (state_.last && coarse_.count == 0);
    if (adds && !live_.undoable) {
        while (!passBoundary())
            step();
        return;
    }
    if (adds) undo();
    if (direct) {
        VkCommandBuffer cmd = kit_.commands.begin();
        kit_.recordRayCount(cmd);
        kit_.run(cmd);
        kit_.countRays();
    } else if (state_.linkSamplePasses == 0) { // convergence begins anew
        state_.series = {};
        state_.convergence = {};
    }
    progress_.passes -= state_.bounce;
    progress_.passFraction = 0;
    state_.stage = Stage::Plan;
    state_.bounce = 0;
    live_.all = true;
    live_.lit = live_.lit && schedule_.hasFirstLight(state_, false);
    live_.ranges.clear();
}

} // namespace relume
