#include "bake/layers/layer_solver.h"

#include "assets/base/error.h"
#include "bake/direct/point_trace.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <type_traits>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;

// A submit, or what a GPU waits for between two batches, takes as long as rays from about so many chunks:
// chunks in smaller gaps come along with those around them. In sample passes of penumbrae alone these have
// hardly any rays.
constexpr uint32_t kGap = 256, kPenumbraGap = 2048;

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
      lamps_(input.device, input.scene, input.patches, {.samples = kPointsOfRound, .chosen = true}),
      buffers_(input.device, input.patches,
               {.linksOfRound = linksOfRound_, .direct = true, .smooth = settings.links.smooth}),
      links_(input.device, {.chunkCount = input.patches.chunkCount(),
                            .links = linksOfRound_,
                            .batch = buffers_.batchChunks,
                            .bytes = settings.cache.keepsLinks() ? settings.cache.bytes : 0}),
      radiancePass_(input.device), gatherPass_(input.device, settings.transport), resolvePass_(input.device),
      layerPass_(input.device), chunkSums_(input.device), parts_(makeTileParts(input.patches)),
      commands_(input.device), timestamps_(input.device, 3 * kMostPortions),
      order_(input.patches.chunkCount()), layerBytes_(settings.layers.bytes) {
    batchMs_ = settings.batchMs;
    settings_.transport.reflectedOnly = true;
    const VkDeviceSize lightBytes = LightBuffers::lightBytes(input.patches);
    if (input.light.radiance.size() != lightBytes) // another solver's nodes
        input.light.radiance = vk::Buffer(input.device, {.size = lightBytes, .name = "radiance"});
    if (!gatherPass_.onCpu())
        bounces_ = std::make_unique<LayerBounces>(input.device, input.light, buffers_.linkSums);
    composite_ = vk::Buffer(input.device, {.size = lightBytes, .name = "composite"});
    penumbra_ = {vk::makeBuffer(input.device, parts_.ofPatch, "parts of tiles"),
                 vk::Buffer(input.device, {.size = parts_.count * sizeof(glm::uvec2), .name = "penumbra"})};
    if (penumbra_.lights.mapped() == nullptr)
        newPenumbra_ = vk::Buffer(
            input.device,
            {.size = penumbra_.lights.size(), .memory = vk::Memory::Host, .name = "penumbra to be"});
    const uint32_t chunks = input.patches.chunkCount();
    const VkDeviceSize changes = 2 * chunks * sizeof(glm::vec4); // of two passes
    const VkDeviceSize sums = chunks * (sizeof(shader::ResolveSums) + sizeof(glm::vec4));
    back_ = vk::Buffer(input.device,
                       {.size = std::max({sums, changes, buffers_.rays.size() + penumbra_.lights.size()}),
                        .memory = vk::Memory::Host,
                        .name = "sums for the CPU"});
    countSenders();
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

// Counts the senders of all chunks at first, then of those in which objects have moved.
void LayerSolver::countSenders() {
    const std::vector<shader::Patch>& patches = input_.patches.scene.patches;
    senders_.resize(input_.patches.chunkCount(), 0);
    fullChunks_.resize(senders_.size(), 0);
    for (uint32_t chunk = 0; chunk < senders_.size(); ++chunk) {
        if (moved_ && !moved_->changes(chunk)) continue;
        const auto first = patches.begin() + size_t{chunk} * kChunk;
        senders_[chunk] =
            static_cast<uint32_t>(std::count_if(first, first + kChunk, [](const shader::Patch& p) {
                return (p.flags & shader::kPatchSends) != 0;
            }));
        fullChunks_[chunk] = std::all_of(
            first, first + kChunk, [](const shader::Patch& p) { return shader::patchIsShown(p.flags); });
    }
}

void LayerSolver::step() {
    const auto start = Clock::now();
    if (edited_ && takesEdits()) adopt();
    if (done_) return;
    if (sumDue_ && work_ && !work_->sum) abortPass();
    const bool relinks = relink_ && !sumComesFirst();
    if (!work_ && !relinks) plan();
    if (relinks) {
        relinkBatch();
    } else if (work_) {
        if (work_->stage == Stage::Direct)
            directBatch();
        else
            linkBatch();
        progress_.passFraction = 1.0 - static_cast<double>(order_.left()) / std::max(1u, order_.count());
    }
    if (isWhole()) unseen_ = false;
    progress_.seconds += secondsSince(start);
}

void LayerSolver::plan() {
    if (sumDue_) return beginSum();
    const std::optional<size_t> stale = staleLayer();
    const std::optional<size_t> unlit = stale && layers_[*stale]->isOutdated() ? std::nullopt : unlitLayer();
    if (unlit) return begin(*unlit, targetOf(*layers_[*unlit]), true);
    const std::optional<size_t> next = stale ? stale : nextLayer();
    if (!next) {
        done_ = true;
        return;
    }
    const std::optional<size_t> direct = stale ? std::nullopt : directFirst(*next);
    const size_t index = direct.value_or(*next);
    begin(index, targetOf(*layers_[index]), direct.has_value());
}

void LayerSolver::begin(size_t index, LayerLevel target, bool directAlone) {
    work_ = Work{.layer = index, .target = target, .directAlone = directAlone};
    penumbraDue_ = false; // of what was aborted
    Layer& layer = *layers_[index];
    if (!layer.stale.empty()) return beginMending();
    work_->round = layer.directRounds;
    if (work_->round >= target.directRounds) return beginBounces();
    if (raysOf(layer) == 0) { // nothing in it shines
        layer.penumbra.assign(parts_.count, 0);
        layer.redoSteps.clear();
    }
    if (work_->round > 0 || raysOf(layer) == 0) setPenumbra(layer); // else the first sample pass finds it
    beginPass(Stage::Direct);
    if (raysOf(layer) == 0 || !seekRound()) endDirectStep(commands_.begin());
}

void LayerSolver::beginPass(Stage stage) {
    work_->stage = stage;
    work_->begun = false;
    order_.begin(input_.patches.chunkCount(), seen_);
}

// Copies into back_, whose former contents are over with.
void LayerSolver::recordBack(VkCommandBuffer cmd, const vk::Buffer& from, VkDeviceSize bytes,
                             VkDeviceSize at) {
    vk::barrier(cmd);
    const VkBufferCopy all{0, at, bytes};
    vkCmdCopyBuffer(cmd, from.handle(), back_.handle(), 1, &all);
}

void LayerSolver::run(VkCommandBuffer cmd) {
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
}

uint32_t LayerSolver::raysOf(const Layer& layer) const {
    uint32_t rays = 0;
    for (const DirectPart& part : layer.parts)
        rays += part.emitters ? emitters_.rays(part.group) : lamps_.rays(part.group);
    return rays;
}

// Returns the next chunks. cost is that of a chunk over that of those that the rate is of; done is the number
// of these in the batch so far.
ChunkRange LayerSolver::nextRange(const BatchRate& rate, uint32_t most, double cost, double done) const {
    const double limit =
        std::clamp((rate.wanted(batchMs_) - done) / cost, 1.0, std::max(1.0, static_cast<double>(most)));
    return order_.next(static_cast<uint32_t>(limit),
                       static_cast<uint32_t>(rate.perMs() / cost * kWorthASubmit));
}

// Makes a batch of direct light. A sample pass goes over the parts of the layer one by one. Tracers that
// record take as much of a step in one submit as fits, for what comes next is known but for the first sample
// pass.
void LayerSolver::directBatch() {
    const std::vector<DirectPart>& parts = layers_[work_->layer]->parts;
    const bool records = !input_.tracer.onCpu();
    const auto start = Clock::now();
    const double most = directRate_.wanted(batchMs_);
    VkCommandBuffer cmd = records ? commands_.begin() : VK_NULL_HANDLE;
    if (records) timestamps_.reset(cmd);
    double done = 0;
    uint32_t portions = 0;
    bool more = true;
    while (more) {
        const DirectPart part = parts[work_->part];
        const uint32_t rays = part.emitters ? emitters_.rays(part.group) : lamps_.rays(part.group);
        if (rays > 0) {
            const double cost = static_cast<double>(rays) / kPointsOfRound;
            const ChunkRange range = nextRange(
                directRate_, part.emitters ? emitters_.batchChunks() : lamps_.batchChunks(), cost, done);
            if (part.emitters)
                traceDirect(cmd, emitters_, part.group, range, 3 * portions);
            else
                traceDirect(cmd, lamps_, part.group, range, 3 * portions);
            ++portions;
            done += range.count * cost;
            order_.finish(range);
        } else {
            order_.finish({0, order_.count()});
        }
        more = (order_.left() > 0 || nextDirect()) && records && done < most && portions < kMostPortions;
    }
    const bool ends = order_.left() == 0;
    if (!ends) {
        if (records) run(cmd);
    } else if (work_->round == 0) {
        endFirstRound(records ? cmd : commands_.begin());
    } else if (work_->mended) {
        if (records) run(cmd);
        endMendingStep();
    } else {
        endDirectStep(records ? cmd : commands_.begin());
    }
    directRate_.note(done, batchMs_, secondsSince(start));
    for (uint32_t i = 0; records && i < portions; ++i) {
        progress_.traceSeconds += 1e-3 * timestamps_.milliseconds(3 * i, 3 * i + 1);
        progress_.gatherSeconds += 1e-3 * timestamps_.milliseconds(3 * i + 1, 3 * i + 2);
    }
}

// Traces a portion; cmd is that of a tracer that records.
template<typename Lights>
void LayerSolver::traceDirect(VkCommandBuffer cmd, const Lights& lights, uint32_t group, ChunkRange range,
                              uint32_t mark) {
    const typename Lights::Work work{
        .group = group, .round = work_->round, .range = range, .penumbra = &penumbra_};
    if constexpr (std::is_same_v<Lights, LampLight>) {
        if (input_.tracer.onCpu() && gatherPass_.onCpu() && lights.onCpu(group)) return traceOnCpu(work);
    }
    const PointTracer on{commands_, timestamps_, input_.tracer};
    const SegmentWork segments = lights.segments(work, buffers_.rays);
    const auto samples = [&](VkCommandBuffer to) {
        recordPenumbraUpload(to);
        if (!work_->begun) vkCmdFillBuffer(to, buffers_.directSums.handle(), 0, VK_WHOLE_SIZE, 0);
        if (!work_->begun && work_->round == 0)
            vkCmdFillBuffer(to, penumbra_.lights.handle(), 0, VK_WHOLE_SIZE, 0);
        vk::barrier(to);
        lights.recordSamples(to, input_.light, work);
    };
    const auto gather = [&](VkCommandBuffer to) {
        lights.recordGather(to, input_.light, work, buffers_.directSums, buffers_.direct);
    };
    if (cmd != VK_NULL_HANDLE) {
        recordPoints(cmd, on, segments, samples, gather, mark);
    } else {
        const PointTimes times = tracePoints(on, segments, samples, gather);
        progress_.traceSeconds += times.trace;
        progress_.gatherSeconds += times.gather;
    }
    work_->begun = true;
}

// Traces and gathers without a submit, which takes longer than a small batch.
void LayerSolver::traceOnCpu(const LampLight::Work& work) {
    // The first part of a layer's first sample pass, with all patches, writes all sums; else they are added
    // to.
    const bool newSums = work_->round == 0 && work_->part == 0 && !work_->mended;
    if (!work_->begun) {
        if (!newSums) std::memset(buffers_.directSums.as<uint8_t>(), 0, buffers_.directSums.size());
        if (work_->round == 0) std::memset(penumbra_.lights.as<uint8_t>(), 0, penumbra_.lights.size());
    }
    work_->begun = true;
    WorkerPool& pool = gatherPass_.pool();
    lamps_.sampleOnCpu(pool, input_.light, work);
    const auto start = Clock::now();
    input_.tracer.segments(VK_NULL_HANDLE, lamps_.segments(work, buffers_.rays));
    const auto traced = Clock::now();
    progress_.traceSeconds += secondsSince(start);
    lamps_.gatherOnCpu(pool, input_.light, work, newSums, buffers_.directSums, buffers_.direct);
    progress_.gatherSeconds += secondsSince(traced);
}

// Returns the sample pass before which this step ends.
uint32_t LayerSolver::directEnd() const {
    const Layer& layer = *layers_[work_->layer];
    if (work_->mended) return layer.directSteps[*work_->mended];
    // A level that was there before is made in the steps that it was made in.
    const auto next = std::upper_bound(layer.redoSteps.begin(), layer.redoSteps.end(), layer.directRounds);
    const uint32_t end = work_->target.directRounds;
    return next == layer.redoSteps.end() ? end : std::min(*next, end);
}

// Finds which chunks take part in the sample pass; tells whether any does.
bool LayerSolver::orderRound() {
    const Layer& layer = *layers_[work_->layer];
    order_.begin(input_.patches.chunkCount(), seen_);
    std::vector<uint8_t> take(order_.count(), 1);
    for (size_t i = 0; work_->mended && i < take.size(); ++i)
        take[i] = layer.mends(i);
    const bool penumbraAlone = work_->round % shader::kPenumbraRounds != 0;
    if (penumbraAlone && work_->penumbra.empty()) {
        for (uint32_t i = 0; i < take.size(); ++i)
            work_->penumbra.push_back(static_cast<uint8_t>(parts_.any(i, layer.penumbra)));
    }
    for (size_t i = 0; penumbraAlone && i < take.size(); ++i)
        take[i] &= work_->penumbra[i];
    if (!input_.tracer.onCpu())
        closeGaps(take, penumbraAlone ? kPenumbraGap : kGap);
    else if (!work_->mended) // of all chunks those between have few patches that take part
        closeGaps(take, kGap);
    for (const ChunkRange& range : rangesOf(take, false))
        order_.finish(range);
    return order_.left() > 0;
}

// Goes on to a sample pass in which any chunk takes part; tells whether the step has one.
bool LayerSolver::seekRound() {
    for (; work_->round < directEnd(); ++work_->round)
        if (orderRound()) return true;
    return false;
}

// Goes on to the part of a step that comes next. Returns false where the step is over, or what comes depends
// on what the first sample pass meets.
bool LayerSolver::nextDirect() {
    if (++work_->part < layers_[work_->layer]->parts.size()) {
        orderRound(); // the same chunks as of the part before
        return true;
    }
    work_->part = 0;
    if (work_->round == 0 && (work_->mended || directEnd() > 1)) return false;
    ++work_->round;
    return seekRound();
}

void LayerSolver::endFirstRound(VkCommandBuffer cmd) {
    recordPenumbra(cmd);
    run(cmd);
    learnPenumbra();
    ++work_->round;
    if (seekRound()) return;
    work_->mended ? endMendingStep() : endDirectStep(commands_.begin());
}

void LayerSolver::endDirectStep(VkCommandBuffer cmd) {
    Layer& layer = *layers_[work_->layer];
    const uint32_t end = directEnd(), rounds = end - layer.directRounds;
    const std::shared_ptr<vk::Buffer> shared = recordOwnDirect(cmd, layer);
    if (!work_->begun) vkCmdFillBuffer(cmd, buffers_.directSums.handle(), 0, VK_WHOLE_SIZE, 0);
    recordPenumbraUpload(cmd);
    vk::barrier(cmd);
    layerPass_.recordDirect(cmd, input_.light, layer, buffers_.directSums, penumbra_, rounds);
    recordRayCount(cmd);
    recordPenumbra(cmd);
    run(cmd);
    countRays();
    learnPenumbra();
    layer.directRounds = end;
    layer.directSteps.push_back(end);
    if (end == work_->target.directRounds) {
        if (!work_->directAlone) return beginBounces();
        work_.reset();
        sumDue_ = canSum();
        return;
    }
    work_->begun = false;
    if (!seekRound()) endDirectStep(commands_.begin());
}

void LayerSolver::recordPenumbra(VkCommandBuffer cmd) {
    recordBack(cmd, penumbra_.lights, penumbra_.lights.size(), buffers_.rays.size());
}

// Learns where the penumbra is; in a repair only of parts that are repaired as a whole. Chunks beside dirty
// ones are done with where it is what it was.
void LayerSolver::learnPenumbra() {
    Layer& layer = *layers_[work_->layer];
    const auto* lights = reinterpret_cast<const glm::uvec2*>(back_.as<uint8_t>() + buffers_.rays.size());
    const auto within = [&](size_t part) { return uint8_t{(lights[part].x & lights[part].y) != 0}; };
    if (!work_->mended) {
        layer.penumbra.resize(parts_.count);
        for (size_t i = 0; i < parts_.count; ++i)
            layer.penumbra[i] = within(i);
        work_->penumbra.clear();
        return;
    }
    std::vector<uint8_t> cut(parts_.count, 0), differs(parts_.count, 0);
    for (uint32_t i = 0; i < layer.stale.size(); ++i)
        if (!layer.mends(i)) parts_.mark(i, cut);
    for (size_t i = 0; i < parts_.count; ++i) {
        differs[i] = cut[i] == 0 && layer.penumbra[i] != within(i);
        if (differs[i] != 0) layer.penumbra[i] = within(i);
    }
    for (uint32_t i = 0; i < layer.stale.size(); ++i) {
        uint8_t& stale = layer.stale[i];
        if (stale != Layer::kBeside && stale != Layer::kBesideBegun) continue;
        const uint8_t as = stale == Layer::kBeside ? 0 : Layer::kBegun;
        stale = parts_.any(i, differs) ? Layer::kStale : as;
    }
    setPenumbra(layer);
}

// Sets the penumbra; in a repair only of what takes part in that, as rays are for these alone.
void LayerSolver::setPenumbra(const Layer& layer) {
    std::vector<uint8_t> parts = layer.penumbra;
    if (work_->mended) {
        std::vector<uint8_t> mended(parts_.count, 0);
        for (uint32_t i = 0; i < layer.stale.size(); ++i)
            if (layer.mends(i)) parts_.mark(i, mended);
        for (size_t i = 0; i < parts.size(); ++i)
            parts[i] &= mended[i];
    }
    const bool direct = penumbra_.lights.mapped() != nullptr; // nothing is under way that uses it
    auto* lights = (direct ? penumbra_.lights : newPenumbra_).as<glm::uvec2>();
    std::transform(parts.begin(), parts.end(), lights, [](uint8_t within) { return glm::uvec2(within); });
    penumbraDue_ = !direct;
    work_->penumbra.clear();
}

void LayerSolver::recordPenumbraUpload(VkCommandBuffer cmd) {
    if (!std::exchange(penumbraDue_, false)) return;
    const VkBufferCopy all{0, 0, penumbra_.lights.size()};
    vkCmdCopyBuffer(cmd, newPenumbra_.handle(), penumbra_.lights.handle(), 1, &all);
}

// Copies direct light that a layer shares with one that is to stay as it is. Returns what the copy is made
// of, to be kept until it is there; nullptr where none was needed.
std::shared_ptr<vk::Buffer> LayerSolver::recordOwnDirect(VkCommandBuffer cmd, Layer& layer) {
    if (layer.direct && layer.direct.use_count() == 1) return nullptr;
    const std::shared_ptr<vk::Buffer> shared =
        std::exchange(layer.direct, std::make_shared<vk::Buffer>(takeBuffer("direct light of a layer")));
    if (!shared) return nullptr;
    const VkBufferCopy all{0, 0, shared->size()};
    vkCmdCopyBuffer(cmd, shared->handle(), layer.direct->handle(), 1, &all);
    return shared;
}

void LayerSolver::recordRayCount(VkCommandBuffer cmd) {
    recordBack(cmd, buffers_.rays, buffers_.rays.size());
    vk::barrier(cmd);
    vkCmdFillBuffer(cmd, buffers_.rays.handle(), 0, VK_WHOLE_SIZE, 0);
}

void LayerSolver::countRays() {
    const uint32_t* counters = back_.as<uint32_t>();
    progress_.rays = std::accumulate(counters, counters + shader::kRayCounters, progress_.rays);
}

// Asks the device for rays of direct light, which it counts for as long as a step of many sample passes
// takes.
uint64_t LayerSolver::raysSoFar() {
    if (work_ && work_->stage == Stage::Direct) {
        VkCommandBuffer cmd = commands_.begin();
        recordRayCount(cmd);
        run(cmd);
        countRays();
    }
    return progress_.rays;
}

void LayerSolver::abortPass() {
    if (!work_) return;
    raysSoFar();
    sumDue_ = sumDue_ || work_->sum;
    work_.reset();
    progress_.passFraction = 0;
}

void LayerSolver::setPriority(std::vector<uint8_t> chunkSeen) {
    ASSERT(chunkSeen.empty() || chunkSeen.size() == input_.patches.chunkCount());
    seen_ = std::move(chunkSeen);
    if (work_) order_.prefer(seen_);
}

} // namespace relume
