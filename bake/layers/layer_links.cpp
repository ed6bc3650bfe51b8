// This part of LayerSolver bounces layers over links.
#include "bake/layers/layer_solver.h"

#include "bake/base/series.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

namespace relume {
namespace {

// The first level is in haste: this iteration error is small enough for it.
constexpr double kFirstIterationError = 0.01;
// The CPU looks for the first time after so many bounces, and then after so many more at most. A look waits
// for the device, which takes longer than a bounce.
constexpr uint32_t kFirstLook = 2, kMostUnseen = 8;
constexpr uint32_t kToldBounces = 2; // the last ones before a look: both changes make a ratio

} // namespace

// Hybrid's first pass is the direct light: with a number of passes the others are gathered over all links.
// Else bounces converge over the links of the first sample pass.
void LayerSolver::beginBounces() {
    Work& work = *work_;
    work.bounce = work.round = 0;
    work.lanes = lanes();
    if (work.target.linkRounds == 0) {
        finishLevel(work.lanes.front());
        return work_.reset();
    }
    if (bounces_) {
        std::vector<const vk::Buffer*> direct;
        for (const Lane& lane : work.lanes)
            direct.push_back(layerOf(lane).direct.get());
        bounces_->begin(direct);
    }
    beginPass(settings_.passes > 0 ? Stage::Gather : Stage::Bounces);
}

// Returns others that are to go on and want as many links, gathered alike.
std::vector<size_t> LayerSolver::companions(size_t index, LayerLevel target) const {
    std::vector<size_t> others;
    for (size_t i = 0; bounces_ && i < layers_.size(); ++i) {
        const Layer& layer = *layers_[i];
        const bool waits = !layer.converged && layer.stale.empty() && layer.source.weight != glm::vec3(0.0f);
        if (i == index || !waits) continue;
        const LayerLevel own = targetOf(layer);
        if (own.linkRounds == target.linkRounds && isHasty(own) == isHasty(target)) others.push_back(i);
    }
    return others;
}

// Returns one of the layers that can bounce together whose direct light is to be made before they do. A
// viewer is in haste for the first level of each.
std::optional<size_t> LayerSolver::directFirst(size_t index) const {
    const LayerLevel target = targetOf(*layers_[index]);
    if (target.linkRounds == 0 || (settings_.live && !layers_[index]->has())) return std::nullopt;
    std::vector<size_t> together = companions(index, target);
    if (together.empty()) return std::nullopt;
    together.insert(together.begin(), index);
    together.resize(std::min<size_t>(together.size(), LayerBounces::kMostLanes));
    for (const size_t i : together)
        if (layers_[i]->directRounds < targetOf(*layers_[i]).directRounds) return i;
    return std::nullopt;
}

// Returns the lanes of the layer itself and of others that have all their direct light.
std::vector<LayerSolver::Lane> LayerSolver::lanes() const {
    std::vector<Lane> lanes = {{.layer = work_->layer, .target = work_->target, .look = kFirstLook}};
    if (work_->sum) return lanes;
    for (const size_t i : companions(work_->layer, work_->target)) {
        const LayerLevel target = targetOf(*layers_[i]);
        if (layers_[i]->directRounds >= target.directRounds && lanes.size() < LayerBounces::kMostLanes)
            lanes.push_back({.layer = i, .target = target, .look = kFirstLook});
    }
    if (lanes.size() > 1) lanes.resize(bounces_->room(static_cast<uint32_t>(lanes.size())));
    return lanes;
}

void LayerSolver::recordRadiance(VkCommandBuffer cmd) {
    vk::barrier(cmd);
    if (bounces_) return bounces_->recordSend(cmd, settings_.transport.reflectivity);
    radiancePass_.record(cmd, input_.light, settings_.transport);
}

// Returns what the first bounce sends: the direct light or, for the sum, what is shown, as an edit changes
// part of it.
const vk::Buffer& LayerSolver::firstLight(const Lane& lane) const {
    return work_->sum && settings_.passes == 0 ? composite_ : *layerOf(lane).direct;
}

// Begins a pass; a gather begins with empty sums.
void LayerSolver::recordPassBegin(VkCommandBuffer cmd) {
    if (!work_->lit) {
        if (work_->bounce == 0 && work_->gathers == 0) {
            std::vector<const vk::Buffer*> first;
            for (const Lane& lane : work_->lanes)
                first.push_back(&firstLight(lane));
            const VkBufferCopy all{0, 0, input_.light.ligIn.size()};
            if (bounces_)
                bounces_->recordStart(cmd, first);
            else
                vkCmdCopyBuffer(cmd, first.front()->handle(), input_.light.ligIn.handle(), 1, &all);
        }
        recordRadiance(cmd);
    }
    if (!bounces_ && work_->stage == Stage::Gather && work_->round == 0)
        vkCmdFillBuffer(cmd, buffers_.linkSums.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    work_->lit = work_->begun = true;
}

// Returns the next portion. `most` is the number of chunks that it takes where links are there.
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
                       .direct = bounces_ ? nullptr : layerOf(work_->lanes.front()).direct.get(),
                       .output = bounces,
                       .accumulate = !bounces,
                       .newSums = work_->round == 0,
                       .range = range}};
}

// Takes later sample passes along that are there as a whole: sums are read and written once for all of them.
void LayerSolver::takeFollowing(LinkPortion& portion, double most) {
    const uint32_t chunks = input_.patches.chunkCount();
    if (!bounces_ || work_->stage != Stage::Gather || portion.range.count < chunks) return;
    for (uint32_t next = work_->round + 1; next < work_->target.linkRounds; ++next) {
        const size_t rounds = 1 + portion.following.size();
        if (rounds == LayerBounces::kMostRounds || static_cast<double>((rounds + 1) * chunks) > most) return;
        const LinkCache::Place place = links_.find(next, 0, chunks);
        if (!place.known || place.count < chunks) return;
        portion.following.push_back(place.links->address() + place.offset * sizeof(uint32_t));
    }
}

void LayerSolver::linkBatch() {
    const LinkPortion portion = nextLinks(gatherRate_.wanted(batchMs_));
    const bool seen = gatherPass_.onCpu() && !input_.tracer.records() ? linksAtOnce(portion)
                      : portion.trace || gatherPass_.onCpu()          ? linksBySubmit(portion)
                                                                      : knownLinksBySubmit(portion);
    if (seen) look();
}

void LayerSolver::recordGather(VkCommandBuffer cmd, const LinkPortion& portion) {
    if (!bounces_) return gatherPass_.record(cmd, input_.light, buffers_, portion.gather);
    const Work& work = *work_;
    const bool bounce = work.stage == Stage::Bounces;
    const uint32_t rounds = bounce ? 1 : work.target.linkRounds;
    const uint32_t sums = work.round == 0 ? shader::kNewSums : shader::kMoreSums;
    std::vector<VkDeviceAddress> links = {portion.gather.address()};
    links.insert(links.end(), portion.following.begin(), portion.following.end());
    const bool lastRound = work.round + links.size() == rounds;
    LayerBounces::Work record{.links = std::move(links),
                              .samples = linksOfRound_,
                              .range = portion.range,
                              .sums = bounce ? shader::kNoSums : sums,
                              .keeps = !bounce || work.bounce + 1 + kToldBounces >= nextLook(),
                              .ends = bounce || (lastRound && !isLastGather()),
                              .scale = 1.0f / static_cast<float>(rounds * linksOfRound_),
                              .reflectivity = settings_.transport.reflectivity,
                              .changes = {}};
    if (tellsChange()) record.changes = (bounce ? work.bounce : work.gathers) % 2;
    bounces_->record(cmd, record);
}

// Counts these links for each layer that bounces along, as it has gathered them.
void LayerSolver::noteLinks(const LinkPortion& portion) {
    const ChunkRange range = portion.range;
    const auto first = senders_.begin() + range.first;
    const uint64_t samples = uint64_t{linksOfRound_} * (1 + portion.following.size());
    const uint64_t count = std::accumulate(first, first + range.count, uint64_t{0}) * samples;
    uint64_t layers = 0;
    for (Lane& lane : work_->lanes) {
        if (!lane.live) continue;
        lane.gathered += count;
        ++layers;
    }
    progress_.rays += portion.trace ? count : 0;
    progress_.raysSaved += count * (layers - (portion.trace ? 1 : 0));
    progress_.linksRead += count;
    links_.note(work_->round, range);
    order_.finish(range);
    work_->round += static_cast<uint32_t>(portion.following.size());
}

// Traces and gathers without a submit, which would take longer than a small batch where the CPU does both.
// Returns whether the CPU is to look, as do those below.
bool LayerSolver::linksAtOnce(const LinkPortion& portion) {
    const auto start = Clock::now();
    if (!work_->lit)
        gatherPass_.startOnCpu(input_.light, settings_.transport.reflectivity, fullChunks_,
                               firstLight(work_->lanes.front()));
    work_->begun = work_->lit = true;
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
    recordGather(cmd, portion);
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

// Records pass after pass, until the time is up, links are not there or the CPU is to look: a GPU's submit
// takes longer than a bounce.
bool LayerSolver::knownLinksBySubmit(LinkPortion portion) {
    const auto start = Clock::now();
    const double most = gatherRate_.wanted(batchMs_);
    VkCommandBuffer cmd = commands_.begin();
    timestamps_.reset(cmd);
    uint32_t chunks = 0, portions = 0;
    bool seen = false;
    takeFollowing(portion, most);
    while (true) {
        if (!work_->begun) recordPassBegin(cmd);
        timestamps_.mark(cmd, 2 * portions);
        recordGather(cmd, portion);
        if (wantsDistances()) gatherPass_.recordDistances(cmd, input_.light, buffers_, portion.gather);
        timestamps_.mark(cmd, 2 * portions + 1);
        noteLinks(portion);
        chunks += portion.range.count * static_cast<uint32_t>(1 + portion.following.size());
        ++portions;
        seen = order_.left() == 0 && recordPassEnd(cmd);
        if (seen || chunks >= most || portions == kMostPortions) break;
        portion = nextLinks(most - chunks);
        if (portion.trace) break;
        takeFollowing(portion, most - chunks);
        vk::barrier(cmd); // the next one adds to the same sums
    }
    run(cmd);
    for (uint32_t i = 0; i < portions; ++i)
        progress_.gatherSeconds += 1e-3 * timestamps_.milliseconds(2 * i, 2 * i + 1);
    gatherRate_.note(chunks, batchMs_, secondsSince(start));
    return seen;
}

// Tells whether the end of the pass under way records commands. The end of a bounce that the CPU gathered
// does not, as the CPU sends, too.
bool LayerSolver::recordsPassEnd() const {
    return work_->stage == Stage::Gather && work_->round + 1 == work_->target.linkRounds && !isLastGather();
}

// Ends a pass: what was gathered is what the next pass, of whichever stage, begins with. Returns whether the
// CPU is to look what became of it; else the next pass has begun.
bool LayerSolver::recordPassEnd(VkCommandBuffer cmd) {
    Work& work = *work_;
    if (work.stage == Stage::Gather) {
        if (++work.round == work.target.linkRounds) return recordGatherEnd(cmd);
        order_.begin(input_.patches.chunkCount(), seen_);
        return false;
    }
    recordPassLight(cmd);
    ++work.bounce;
    if (work.bounce < nextLook()) {
        beginPass(Stage::Bounces);
        return false;
    }
    recordChanges(cmd);
    return true;
}

// Ends a gather. What has converged over few links has their noise, which all links see then: it is gathered
// again until the light has converged over all of them, unless that is for a look only.
bool LayerSolver::recordGatherEnd(VkCommandBuffer cmd) {
    Work& work = *work_;
    const bool last = isLastGather();
    if (!last) recordPassLight(cmd);
    work.round = 0;
    ++work.gathers;
    if (last) return true;
    work.lit = true;
    if (settings_.passes > 0 || work.gathers == 1) {
        beginPass(Stage::Gather);
        return false;
    }
    recordChanges(cmd);
    return true;
}

// Tells whether this gather is known to be the last one before it is made.
bool LayerSolver::isLastGather() const {
    if (settings_.passes > 0) return work_->gathers + 2 >= settings_.passes;
    return work_->target.linkRounds == 1 || isHasty(work_->target);
}

// Tells whether the change of the pass under way is told, while its end is recorded.
bool LayerSolver::tellsChange() const {
    if (work_->stage == Stage::Gather) return settings_.passes == 0;
    return work_->bounce + kToldBounces >= nextLook();
}

// Makes the light that was gathered what is sent next.
void LayerSolver::recordPassLight(VkCommandBuffer cmd) {
    if (bounces_) {
        vk::barrier(cmd);
        return bounces_->endPass();
    }
    const Work& work = *work_;
    const uint32_t chunks = input_.patches.chunkCount();
    if (work.stage == Stage::Bounces) {
        auto* changes = tellsChange() ? back_.as<glm::vec4>() + size_t{work.bounce % 2} * chunks : nullptr;
        gatherPass_.sendOnCpu(input_.light, settings_.transport.reflectivity, fullChunks_, changes);
        return std::swap(input_.light.ligIn, input_.light.ligOut);
    }
    std::swap(input_.light.ligIn, input_.light.ligOut);
    vk::barrier(cmd);
    gatherPass_.recordCompose(cmd, input_.light, buffers_, layerOf(work.lanes.front()).direct.get(),
                              work.target.linkRounds * linksOfRound_);
    if (tellsChange()) {
        vk::barrier(cmd);
        resolvePass_.recordChange(cmd, input_.light, buffers_);
        recordBack(cmd, buffers_.chunkSums, chunks * sizeof(glm::vec4),
                   work.gathers % 2 * chunks * sizeof(glm::vec4));
    }
    recordRadiance(cmd);
}

// Reads back what changed for the CPU, where it does not gather itself.
void LayerSolver::recordChanges(VkCommandBuffer cmd) {
    if (!bounces_) return;
    bounces_->recordChanges(cmd);
    recordBack(cmd, bounces_->changes(), bounces_->changes().size());
}

uint32_t LayerSolver::nextLook() const {
    uint32_t next = kMaxPasses;
    for (const Lane& lane : work_->lanes)
        if (lane.live) next = std::min(next, lane.look);
    return next;
}

// Looks what came of a pass and decides what is next, which depends on each layer's light alone, not on how
// batches were cut nor on who bounces along.
void LayerSolver::look() {
    Work& work = *work_;
    if (work.stage == Stage::Gather) return lookAtGather();
    uint32_t live = 0;
    for (uint32_t i = 0; i < work.lanes.size(); ++i) {
        Lane& lane = work.lanes[i];
        if (lane.live && lane.look == work.bounce) {
            learnChanges(lane, lane.look - lane.looked > 1);
            lane.looked = lane.look;
            lane.look += bouncesToAim(lane);
            lane.live = lane.iterationError > iterationAim(lane) && work.bounce < kMaxPasses;
        }
        if (lane.live) live |= 1u << i;
    }
    if (bounces_) bounces_->setLive(live);
    if (live != 0) return beginPass(Stage::Bounces);
    for (Lane& lane : work.lanes)
        lane.live = true;
    if (bounces_) bounces_->setLive((1u << work.lanes.size()) - 1u);
    work.lit = work.lanes.size() == 1; // of others some have stood by while light bounced on
    beginPass(Stage::Gather);
}

void LayerSolver::lookAtGather() {
    Work& work = *work_;
    const bool told = settings_.passes == 0 && !isLastGather();
    std::vector<uint32_t> ended;
    uint32_t live = 0;
    for (uint32_t i = 0; i < work.lanes.size(); ++i) {
        Lane& lane = work.lanes[i];
        if (!lane.live) continue;
        if (told) learnChanges(lane, work.gathers == 2);
        lane.live = told && lane.iterationError > iterationAim(lane) && work.gathers + 1 < kMaxPasses;
        if (lane.live)
            live |= 1u << i;
        else
            ended.push_back(i);
    }
    if (bounces_) bounces_->setLive(live);
    for (const uint32_t i : ended) // what was read back is learnt by now
        finishLevel(work.lanes[i]);
    live != 0 ? beginPass(Stage::Gather) : work_.reset();
}

double LayerSolver::iterationAim(const Lane& lane) const {
    const double aim = settings_.error > 0 ? kIterationShare * settings_.error : kLeastIterationError;
    return isHasty(lane.target) ? std::max(aim, kFirstIterationError) : aim;
}

// Learns what the last pass changed; `both` says that what the pass before changed has not been seen yet.
void LayerSolver::learnChanges(Lane& lane, bool both) {
    const Work& work = *work_;
    const uint32_t passes = work.stage == Stage::Gather ? work.gathers : work.bounce; // this one, too
    const auto index = static_cast<uint32_t>(&lane - work.lanes.data());
    const uint32_t chunks = input_.patches.chunkCount();
    const auto total = [&](uint32_t pass) {
        const uint32_t slot = (pass - 1) % 2;
        if (bounces_) return glm::dvec4(back_.as<glm::vec4>()[slot * bounces_->lanes() + index]);
        return sumsOf(std::span(back_.as<glm::vec4>() + size_t{slot} * chunks, chunks));
    };
    if (both) {
        lane.change = 0; // of another stage, or of a pass long before
        learnChange(lane, total(passes - 1));
    }
    learnChange(lane, total(passes));
}

void LayerSolver::learnChange(Lane& lane, const glm::dvec4& total) {
    const double change = total.z > 0 ? std::sqrt(total.x / (3.0 * total.z)) : 0.0;
    const double mean = total.z > 0 ? total.y / (3.0 * total.z) : 0.0;
    if (const std::optional<SeriesRest> rest = seriesRest(lane.change, change, mean)) {
        lane.ratio = rest->ratio;
        lane.iterationError = rest->error;
    }
    lane.change = change;
}

// Returns how many bounces there are to the aim, as the ratio of the last two changes has it.
uint32_t LayerSolver::bouncesToAim(const Lane& lane) const {
    const double more = std::log(iterationAim(lane) / lane.iterationError) / std::log(lane.ratio);
    const double most = std::min(kMostUnseen, kMaxPasses - std::min(work_->bounce, kMaxPasses - 1));
    return lane.ratio < 1.0 && more > 1.0 ? static_cast<uint32_t>(std::ceil(std::min(more, most))) : 1;
}

// Tells whether distances are made: those of the first sample pass's links are the same for every layer.
bool LayerSolver::wantsDistances() const {
    return buffers_.distances && !distancesKnown_ && work_->stage == Stage::Gather && work_->round == 0;
}

} // namespace relume
