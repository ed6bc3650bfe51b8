// Of LayerSolver: bounces of a layer over links.
#include "bake/layer_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace relume {
namespace {

// Of the error that is asked for, what bounces may leave.
constexpr double kIterationShare = 0.2;
constexpr double kLeastIterationError = 1e-4;
// Of the first level, which is in haste.
constexpr double kFirstIterationError = 0.01;
// Bounces after which the CPU looks for the first time, and between two looks at most. A look waits for the
// device, which takes longer than a bounce.
constexpr uint32_t kFirstLook = 2, kMostUnseen = 8;

} // namespace

// Hybrid's first pass is the direct light: with a number of passes the others are gathered over all links.
// Else bounces settle over the links of the first round.
void LayerSolver::beginBounces() {
    work_->bounce = work_->round = work_->looked = 0;
    work_->look = kFirstLook;
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

// most: chunks of links that are there.
LayerSolver::LinkPortion LayerSolver::nextLinks(double most) {
    const uint32_t next = order_.next(1, 0).first;
    const LinkCache::Place place = links_.find(work_->round, next, input_.patches.chunkCount() - next);
    const bool trace = !place.known;
    const double done = gatherRate_.wanted(batchMs_) - most;
    const ChunkRange range = trace ? nextRange(traceRate_, std::min(place.count, buffers_.batchChunks))
                                   : nextRange(gatherRate_, place.count, 1, done);
    const bool bounces = work_->stage == Stage::Bounces;
    return {.trace = trace,
            .range = range,
            .closest = {.firstChunk = range.first,
                        .chunkCount = range.count,
                        .firstSample = work_->round * linksOfRound_,
                        .sampleCount = linksOfRound_,
                        .rotation = settings_.links.rotation,
                        .links = place.links,
                        .linksOffset = place.offset},
            .gather = {.links = place.links,
                       .linksOffset = place.offset,
                       .samples = linksOfRound_,
                       .direct = working().direct.get(),
                       .output = bounces,
                       .accumulate = !bounces,
                       .range = range}};
}

void LayerSolver::linkBatch() {
    const LinkPortion portion = nextLinks(gatherRate_.wanted(batchMs_));
    const bool seen = gatherPass_.onCpu() && !input_.tracer.records() ? linksAtOnce(portion)
                      : portion.trace || gatherPass_.onCpu()          ? linksBySubmit(portion)
                                                                      : knownLinksBySubmit(portion);
    if (seen) look();
}

void LayerSolver::noteLinks(const LinkPortion& portion) {
    const ChunkRange range = portion.range;
    const auto first = senders_.begin() + range.first;
    const uint64_t count = std::accumulate(first, first + range.count, uint64_t{0}) * linksOfRound_;
    (portion.trace ? progress_.rays : progress_.raysSaved) += count;
    progress_.pairs += count;
    links_.note(work_->round, range);
    order_.finish(range);
}

// Where the CPU does both, a submit would take longer than a small batch. Returns whether the CPU is to look,
// as do those below.
bool LayerSolver::linksAtOnce(const LinkPortion& portion) {
    const auto start = Clock::now();
    const bool sums = work_->stage == Stage::Gather && work_->round == 0;
    if (!work_->begun && (!work_->lit || sums)) {
        VkCommandBuffer cmd = commands_.begin();
        recordPassBegin(cmd);
        run(cmd);
    }
    work_->begun = true;
    const auto linksStart = Clock::now();
    if (portion.trace) input_.tracer.closest(VK_NULL_HANDLE, portion.closest);
    const double traced = secondsSince(linksStart);
    gatherPass_.record(VK_NULL_HANDLE, input_.light, buffers_, portion.gather);
    progress_.traceSeconds += traced;
    progress_.gatherSeconds += secondsSince(linksStart) - traced;
    noteLinks(portion);
    const bool ends = order_.left() == 0, submits = wantsDistances() || (ends && recordsPassEnd());
    VkCommandBuffer cmd = submits ? commands_.begin() : VK_NULL_HANDLE;
    if (wantsDistances()) gatherPass_.recordDistances(cmd, input_.light, buffers_, portion.gather);
    const bool seen = ends && recordPassEnd(cmd);
    if (submits) run(cmd);
    (portion.trace ? traceRate_ : gatherRate_).note(portion.range.count, batchMs_, secondsSince(start));
    return seen;
}

bool LayerSolver::linksBySubmit(const LinkPortion& portion) {
    const auto start = Clock::now();
    VkCommandBuffer cmd = commands_.begin();
    if (!work_->begun) recordPassBegin(cmd);
    timestamps_.reset(cmd);
    timestamps_.mark(cmd, 0);
    const auto traceStart = Clock::now();
    if (portion.trace) input_.tracer.closest(cmd, portion.closest);
    const double cpuTrace = secondsSince(traceStart);
    vk::barrier(cmd);
    timestamps_.mark(cmd, 1);
    if (gatherPass_.onCpu()) { // which then counts into the time between the same two marks
        run(cmd);
        cmd = commands_.begin();
    }
    gatherPass_.record(cmd, input_.light, buffers_, portion.gather);
    if (wantsDistances()) gatherPass_.recordDistances(cmd, input_.light, buffers_, portion.gather);
    timestamps_.mark(cmd, 2);
    noteLinks(portion);
    const bool seen = order_.left() == 0 && recordPassEnd(cmd);
    run(cmd);
    progress_.traceSeconds +=
        input_.tracer.onCpu() && portion.trace ? cpuTrace : 1e-3 * timestamps_.milliseconds(0, 1);
    progress_.gatherSeconds += 1e-3 * timestamps_.milliseconds(1, 2);
    (portion.trace ? traceRate_ : gatherRate_).note(portion.range.count, batchMs_, secondsSince(start));
    return seen;
}

// Pass after pass, until the time is up, links are not there or the CPU is to look: a GPU's submit takes
// longer than a bounce.
bool LayerSolver::knownLinksBySubmit(LinkPortion portion) {
    const auto start = Clock::now();
    const double most = gatherRate_.wanted(batchMs_);
    VkCommandBuffer cmd = commands_.begin();
    timestamps_.reset(cmd);
    uint32_t chunks = 0, portions = 0;
    bool seen = false;
    while (true) {
        if (!work_->begun) recordPassBegin(cmd);
        timestamps_.mark(cmd, 2 * portions);
        gatherPass_.record(cmd, input_.light, buffers_, portion.gather);
        if (wantsDistances()) gatherPass_.recordDistances(cmd, input_.light, buffers_, portion.gather);
        timestamps_.mark(cmd, 2 * portions + 1);
        noteLinks(portion);
        chunks += portion.range.count;
        ++portions;
        seen = order_.left() == 0 && recordPassEnd(cmd);
        if (seen || chunks >= most || portions == kMostPortions) break;
        portion = nextLinks(most - chunks);
        if (portion.trace) break;
        vk::barrier(cmd); // the next one adds to the same sums
    }
    run(cmd);
    for (uint32_t i = 0; i < portions; ++i)
        progress_.gatherSeconds += 1e-3 * timestamps_.milliseconds(2 * i, 2 * i + 1);
    gatherRate_.note(chunks, batchMs_, secondsSince(start));
    return seen;
}

// Of the first round's links: the same for every layer.
bool LayerSolver::wantsDistances() const {
    return buffers_.distances && !distancesKnown_ && work_->stage == Stage::Gather && work_->round == 0;
}

// Whether the end of the pass under way is more than to count it.
bool LayerSolver::recordsPassEnd() const {
    return work_->stage == Stage::Bounces || work_->round + 1 == work_->target.linkRounds;
}

// What was gathered is what the next pass, of whichever stage, begins with. Returns whether the CPU is to
// look what became of it; else the next pass has begun.
bool LayerSolver::recordPassEnd(VkCommandBuffer cmd) {
    Work& work = *work_;
    if (work.stage == Stage::Gather) {
        if (++work.round == work.target.linkRounds) return recordGatherEnd(cmd);
        order_.begin(input_.patches.chunkCount(), seen_);
        return false;
    }
    ++progress_.passes;
    ++work.bounce;
    if (work.bounce + 1 >= work.look) recordChange(cmd, work.bounce == work.look);
    std::swap(input_.light.ligIn, input_.light.ligOut);
    recordRadiance(cmd);
    if (work.bounce == work.look) return true;
    beginPass(Stage::Bounces);
    return false;
}

// What has settled over few links has their noise, which all links see then: it is gathered again until the
// light has settled over all of them.
bool LayerSolver::recordGatherEnd(VkCommandBuffer cmd) {
    Work& work = *work_;
    ++work.gathers;
    ++progress_.passes;
    work.round = 0;
    const bool counted = settings_.passes > 0;
    if (counted ? work.gathers + 1 >= settings_.passes : work.target.linkRounds == 1) return true;
    std::swap(input_.light.ligIn, input_.light.ligOut);
    vk::barrier(cmd);
    gatherPass_.recordCompose(cmd, input_.light, buffers_, working().direct.get(),
                              work.target.linkRounds * linksOfRound_);
    if (!counted) recordChange(cmd, work.gathers > 1);
    recordRadiance(cmd);
    work.lit = true;
    if (!counted && work.gathers > 1) return true;
    beginPass(Stage::Gather);
    return false;
}

// From ligIn to ligOut or back. Slot 1: of the pass that the CPU looks at; 0: of the one before.
void LayerSolver::recordChange(VkCommandBuffer cmd, uint32_t slot) {
    const VkDeviceSize bytes = input_.patches.chunkCount() * sizeof(glm::vec4);
    vk::barrier(cmd);
    resolvePass_.recordChange(cmd, input_.light, buffers_);
    recordBack(cmd, buffers_.chunkSums, bytes, slot * bytes);
}

// What came of a pass decides what is next: which depends on the light alone, not on how batches were cut.
void LayerSolver::look() {
    Work& work = *work_;
    const bool gather = work.stage == Stage::Gather;
    if (gather && (settings_.passes > 0 || work.target.linkRounds == 1)) return finishLevel();
    const bool first = gather ? work.gathers == 2 : work.looked == 0;
    if (first || (!gather && work.look - work.looked > 1)) {
        work.change = 0; // of another kind of pass, or of one long before
        learnChange(0);
    }
    learnChange(1);
    if (gather) return gathered() ? finishLevel() : beginPass(Stage::Gather);
    const bool last = work.iterationError <= iterationAim() || work.bounce >= kMaxPasses;
    work.looked = work.look;
    work.look += bouncesToAim();
    beginPass(last ? Stage::Gather : Stage::Bounces);
}

// As the ratio of the last two has it.
uint32_t LayerSolver::bouncesToAim() const {
    const double more = std::log(iterationAim() / work_->iterationError) / std::log(work_->ratio);
    const double most = std::min(kMostUnseen, kMaxPasses - std::min(work_->bounce, kMaxPasses - 1));
    return work_->ratio < 1.0 && more > 1.0 ? static_cast<uint32_t>(std::ceil(std::min(more, most))) : 1;
}

double LayerSolver::iterationAim() const {
    const double aim = settings_.error > 0 ? kIterationShare * settings_.error : kLeastIterationError;
    const bool first = work_->target == firstLevel() && !(work_->target == lastLevel());
    return first ? std::max(aim, kFirstIterationError) : aim;
}

// The remaining error of a geometric series: change q / (1 - q), q being the ratio of the last two changes
// (conventions.md, Errors). A light that reaches nothing has settled at once.
void LayerSolver::learnChange(uint32_t slot) {
    const uint32_t chunks = input_.patches.chunkCount();
    const glm::dvec4 total = sumsOf(std::span(back_.as<glm::vec4>() + size_t{slot} * chunks, chunks));
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

bool LayerSolver::gathered() const {
    return work_->gathers + 1 >= kMaxPasses ||
           (work_->gathers > 1 && work_->iterationError <= iterationAim());
}

} // namespace relume
