// Of LayerSolver: bounces of a layer over links.
#include "bake/layer_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace relume {
namespace {

// Of the first level, which is in haste.
constexpr double kFirstIterationError = 0.01;

} // namespace

// Hybrid's first pass is the direct light: with a number of passes the others are gathered over all links.
// Else bounces settle over the links of the first round.
void LayerSolver::beginBounces() {
    work_->bounce = work_->round = 0;
    if (work_->target.linkRounds == 0) return finishLevel();
    beginPass(settings_.passes > 0 ? Stage::Gather : Stage::Bounces);
}

void LayerSolver::recordRadiance(VkCommandBuffer cmd) {
    vk::barrier(cmd);
    radiancePass_.record(cmd, input_.light, settings_.transport);
    vk::barrier(cmd);
    gatherPass_.recordPack(cmd, input_.light, buffers_);
}

// The first bounce is that of the direct light, or, for the sum, of what is shown: an edit changes part of
// it. To gather is to begin with sums of nothing.
void LayerSolver::recordPassBegin(VkCommandBuffer cmd) {
    if (!work_->lit) {
        if (work_->bounce == 0 && work_->gathers == 0) {
            const VkBufferCopy all{0, 0, input_.light.ligIn.size()};
            const vk::Buffer& first = work_->sum && settings_.passes == 0 ? composite_ : *working().direct;
            vkCmdCopyBuffer(cmd, first.handle(), input_.light.ligIn.handle(), 1, &all);
        }
        recordRadiance(cmd);
    }
    if (work_->stage == Stage::Gather && work_->round == 0)
        vkCmdFillBuffer(cmd, buffers_.linkSums.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    work_->lit = work_->begun = true;
}

void LayerSolver::linkBatch() {
    const Layer& layer = working();
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
                                    .direct = layer.direct.get(),
                                    .output = bounces,
                                    .accumulate = !bounces,
                                    .range = range};
    const bool endsBounce = bounces && order_.left() == range.count;
    if (gatherPass_.onCpu() && !input_.tracer.records())
        linksAtOnce(trace ? &closest : nullptr, work, endsBounce);
    else
        linksBySubmit(trace ? &closest : nullptr, work, endsBounce);
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

// Where the CPU does both, a submit would take longer than a small batch.
void LayerSolver::linksAtOnce(const ClosestWork* closest, const LinkGatherPass::Work& work, bool endsBounce) {
    const bool sums = work_->stage == Stage::Gather && work_->round == 0;
    if (!work_->begun && (!work_->lit || sums)) {
        VkCommandBuffer cmd = commands_.begin();
        recordPassBegin(cmd);
        run(cmd);
    }
    work_->begun = true;
    const auto start = Clock::now();
    if (closest) input_.tracer.closest(VK_NULL_HANDLE, *closest);
    const double traced = secondsSince(start);
    gatherPass_.record(VK_NULL_HANDLE, input_.light, buffers_, work);
    progress_.traceSeconds += traced;
    progress_.gatherSeconds += secondsSince(start) - traced;
    if (!wantsDistances() && !endsBounce) return;
    VkCommandBuffer cmd = commands_.begin();
    if (wantsDistances()) gatherPass_.recordDistances(cmd, input_.light, buffers_, work);
    if (endsBounce) recordBounceEnd(cmd);
    run(cmd);
}

void LayerSolver::linksBySubmit(const ClosestWork* closest, const LinkGatherPass::Work& work,
                                bool endsBounce) {
    VkCommandBuffer cmd = commands_.begin();
    if (!work_->begun) recordPassBegin(cmd);
    timestamps_.reset(cmd);
    timestamps_.mark(cmd, 0);
    const auto start = Clock::now();
    if (closest) input_.tracer.closest(cmd, *closest);
    const double cpuTrace = secondsSince(start);
    vk::barrier(cmd);
    timestamps_.mark(cmd, 1);
    if (gatherPass_.onCpu()) { // which then counts into the time between the same two marks
        run(cmd);
        cmd = commands_.begin();
    }
    gatherPass_.record(cmd, input_.light, buffers_, work);
    if (wantsDistances()) gatherPass_.recordDistances(cmd, input_.light, buffers_, work);
    timestamps_.mark(cmd, 2);
    if (endsBounce) recordBounceEnd(cmd);
    run(cmd);
    progress_.traceSeconds +=
        input_.tracer.onCpu() && closest ? cpuTrace : 1e-3 * timestamps_.milliseconds(0, 1);
    progress_.gatherSeconds += 1e-3 * timestamps_.milliseconds(1, 2);
}

// Of the first round's links: the same for every layer.
bool LayerSolver::wantsDistances() const {
    return buffers_.distances && !distancesKnown_ && work_->stage == Stage::Gather && work_->round == 0;
}

// What was gathered is what the next pass, of whichever stage, begins with.
void LayerSolver::recordBounceEnd(VkCommandBuffer cmd) {
    recordChange(cmd);
    std::swap(input_.light.ligIn, input_.light.ligOut);
    recordRadiance(cmd);
}

// From ligIn to ligOut or back.
void LayerSolver::recordChange(VkCommandBuffer cmd) {
    vk::barrier(cmd);
    resolvePass_.recordChange(cmd, input_.light, buffers_);
    recordBack(cmd, buffers_.chunkSums, input_.patches.chunkCount() * sizeof(glm::vec4));
}

void LayerSolver::endBounce() {
    ++progress_.passes;
    learnChange();
    const bool last = work_->iterationError <= iterationAim() || work_->bounce + 1 >= kMaxPasses;
    ++work_->bounce;
    beginPass(last ? Stage::Gather : Stage::Bounces);
}

double LayerSolver::iterationAim() const {
    const double aim = settings_.error > 0 ? kIterationShare * settings_.error : kLeastIterationError;
    const bool first = work_->target == firstLevel() && !(work_->target == lastLevel());
    return first ? std::max(aim, kFirstIterationError) : aim;
}

// The remaining error of a geometric series: change q / (1 - q), q being the ratio of the last two changes
// (conventions.md, Errors). A light that reaches nothing has settled at once.
void LayerSolver::learnChange() {
    const glm::dvec4 total = sumsOf(std::span(back_.as<glm::vec4>(), input_.patches.chunkCount()));
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

// What has settled over few links has their noise, which all links see then: it is gathered again until the
// light has settled over all of them.
void LayerSolver::endGather() {
    ++work_->gathers;
    ++progress_.passes;
    work_->round = 0;
    if (work_->target.linkRounds == 1 && settings_.passes == 0) return finishLevel();
    if (settings_.passes > 0 && work_->gathers + 1 >= settings_.passes) return finishLevel();
    std::swap(input_.light.ligIn, input_.light.ligOut);
    VkCommandBuffer cmd = commands_.begin();
    gatherPass_.recordCompose(cmd, input_.light, buffers_, working().direct.get(),
                              work_->target.linkRounds * linksOfRound_);
    if (settings_.passes == 0) recordChange(cmd);
    recordRadiance(cmd);
    run(cmd);
    work_->lit = true;
    if (settings_.passes == 0) {
        if (work_->gathers == 1) work_->change = 0; // the noise of what was there before
        learnChange();
        if (gathered()) return finishLevel();
    }
    beginPass(Stage::Gather);
}

bool LayerSolver::gathered() const {
    return work_->gathers + 1 >= kMaxPasses ||
           (work_->gathers > 1 && work_->iterationError <= iterationAim());
}

} // namespace relume
