#include "bake/links/link_solver.h"

#include "bake/gather/sky_links.h"
#include "bake/links/directions.h"
#include "bake/links/link_memory.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace relume {
namespace {

using shader::kChunk;

// A submit interpolates so many chunks: 0.26M patches take about 20 ms on two cores.
constexpr uint32_t kInterpolatedChunks = 4096;
// A sample pass of some chunks takes as long as so many rays: threads wait for each other, and a GPU takes
// 0.2 ms however short it is. What is planned must not hang on the number of threads.
constexpr double kPassRaysOnCpu = 1 << 12, kPassRaysOnGpu = 1 << 22;

static_assert(std::is_trivially_copyable_v<LinkState>);
static_assert(kMostBounces == Solver::kMaxPasses);

uint32_t linksOf(const SolverInput& input, const SolverSettings& settings) {
    return linksOfSamplePass(input.patches.count, settings.links.samples, input.device.info().software());
}

EmitterLight makeEmitters(const SolverInput& input, const SolverSettings& settings) {
    const PatchSet& patches = input.patches;
    EmitterLight light(input.device, patches, {linksOf(input, settings), settings.links.allOver});
    const bool hybrid = settings.method == Method::Hybrid;
    light.setGroups({hybrid ? buildEmitters(input.scene, patches.scene.mesh, {.size = patches.scene.size})
                            : EmitterSet{}});
    return light;
}

// Returns the patches that links start from.
const std::vector<shader::Patch>& receiversOf(const SolverInput& input, const CoarsePatches& coarse) {
    return coarse.count > 0 ? coarse.receivers : input.patches.scene.patches;
}

// Hybrid keeps emission out of what patches send: it is direct light's.
SolverSettings withTransport(SolverSettings settings) {
    settings.transport.reflectedOnly = settings.method == Method::Hybrid;
    return settings;
}

// Makes what links read of the patches' radiance.
void recordReadable(VkCommandBuffer cmd, const LinkKit& kit, const std::optional<Footprints>& footprints) {
    const LightBuffers& light = kit.input.light;
    if (footprints) {
        footprints->recordLevels(cmd, light.radiance);
        vk::barrier(cmd);
    }
    kit.gatherPass.recordPack(cmd, light, kit.buffers);
}

// Lets the links of portions read the means of groups, whatever traced them.
void recordFootprints(VkCommandBuffer cmd, const LinkKit& kit, const Footprints& footprints,
                      std::span<const LinkBatches::Portion> portions, uint32_t samples) {
    const vk::Buffer& patches = kit.input.light.patches;
    for (const LinkBatches::Portion& portion : portions) {
        const vk::Buffer& receivers = portion.closest.receivers ? *portion.closest.receivers : patches;
        footprints.recordLinks(cmd, patches.address(),
                               {.receivers = receivers.address(),
                                .links = portion.gather.address(),
                                .firstChunk = portion.range.first,
                                .chunkCount = portion.range.count,
                                .sampleCount = kit.linksOfSamplePass,
                                .samples = samples});
    }
    vk::barrier(cmd);
}

// Returns how many directions the set has. Each replicate goes through it once; where the error decides how
// many sample passes there will be, once per sample pass: a set that is broken off is less even.
uint32_t directionsOf(const SolverSettings& settings, const LinkSchedule& schedule, uint32_t links) {
    if (settings.links.directions != DirectionSet::Lec) return 0;
    const uint32_t samplePasses = settings.links.samples > 0 ? schedule.samplePassesWanted() : 1;
    return samplePasses * links / shader::kReplicates;
}

vk::Buffer makeDisc(const vk::Device& device, uint32_t count) {
    std::vector<glm::vec2> points;
    points.reserve(count);
    for (const glm::dvec2 p : evenRings(largestEmptyCircleDisc(count)))
        points.emplace_back(p);
    return vk::makeBuffer(device, points, "directions");
}

} // namespace

LinkSolver::LinkSolver(const SolverInput& input, const SolverSettings& settings)
    : emitters_(makeEmitters(input, settings)),
      sky_(linksSeeSky(input.scene.sky, settings) ? input.scene.sky.radiance : glm::vec3(0.0f)),
      lamps_(input.device, input.scene, input.patches,
             {.samples = linksOf(input, settings),
              .sky = sky_ == glm::vec3(0.0f),
              .allOver = settings.links.allOver}),
      coarse_(settings.links.indirectScale > 1
                  ? buildCoarsePatches(input.patches, settings.links.indirectScale)
                  : CoarsePatches{}),
      kit_(input,
           {.settings = withTransport(settings),
            .linksOfSamplePass = linksOf(input, settings),
            .buffers = {.direct = hasDirect(),
                        .smooth = settings.method == Method::Hybrid && settings.links.smooth,
                        .local = true,
                        .notes = !lamps_.empty() && samplesPerChunk(settings, input.device.info().software()),
                        .carries = settings.passes == 0,
                        .spill = settings.spill,
                        .coarse = coarse_.count > 0 ? &coarse_ : nullptr},
            .chunks = std::max(input.patches.chunkCount(), coarse_.chunkCount()),
            .progress = progress_,
            .batchMs = batchMs_}),
      batches_(kit_, {.chunkCount = static_cast<uint32_t>(receiversOf(input, coarse_).size() / kChunk),
                      .links = kit_.linksOfSamplePass,
                      .batch = kit_.buffers.batchChunks,
                      .bytes = settings.cache.keepsLinks() ? settings.cache.bytes : 0,
                      .deviceBytes = settings.cache.deviceBytes,
                      .chunks = kit_.rankChunks.linked(),
                      .oneSamplePass = true}),
      errors_(kit_), senders_(input.device.workers(), receiversOf(input, coarse_)),
      schedule_(rules()), disc_{.count = directionsOf(kit_.settings, schedule_, kit_.linksOfSamplePass),
                                .points = {}},
      radiancePass_(input.device),
      sendsOnHost_(kit_.gatherPass.onCpu() && kit_.settings.transport.reflectedOnly &&
                   kit_.rankChunks.alone() && coarse_.count == 0 && !settings.links.footprint),
      directSamplePasses_(kit_.chunkCount()), linkSamplePasses_(senders_.chunks()),
      directPlan_(input.device.workers(), kit_.chunkCount()), directPortions_(kit_) {
    ASSERT(input.ranks.alone() || (!settings.live && coarse_.count == 0));
    batchMs_ = settings.batchMs;
    if (disc_.count > 0) disc_.points = makeDisc(input.device, disc_.count);
    const PatchSet& patches = input.patches;
    LinkBuffers& buffers = kit_.buffers;
    if (settings.links.footprint) footprints_.emplace(input.device, patches);
    input.light.resizeRadiance(input.device, footprints_ ? footprints_->radianceBytes() : kit_.lightBytes());
    if (!kit_.gatherPass.onCpu())
        buffers.packed = vk::Buffer(
            input.device, {.size = input.light.radiance.size() / sizeof(glm::vec4) * sizeof(glm::uvec2),
                           .name = "packed radiance"});
    kit_.reserveBack(buffers.rays.size());
    VkCommandBuffer cmd = kit_.commands.begin();
    for (const vk::Buffer* buffer :
         {&buffers.linkSums, &buffers.directSums, &buffers.direct, &buffers.carried, &buffers.rays,
          &buffers.result, &input.light.ligIn, &input.light.ligOut}) {
        if (*buffer) vkCmdFillBuffer(cmd, buffer->handle(), 0, VK_WHOLE_SIZE, 0);
    }
    kit_.run(cmd);
    if (settings.live && !buffers.rows)
        undo_ = vk::Buffer(input.device, {.size = buffers.linkSums.size(),
                                          .memory = memoryFrom(Spill::Links, settings.spill),
                                          .name = "sums before the sample pass"});
    progress_.cacheBytes = batches_.cache().bytes();
    progress_.cachedShare = batches_.cache().share();
}

LinkRules LinkSolver::rules() const {
    const SolverSettings& settings = kit_.settings;
    const double linkShare = static_cast<double>(senders_.chunks()) / kit_.chunkCount();
    return {.hybrid = settings.method == Method::Hybrid,
            .hasDirect = hasDirect(),
            .linksOfSamplePass = kit_.linksOfSamplePass,
            .samples = settings.links.samples,
            .passes = settings.passes,
            .error = settings.error,
            .localError = settings.localError,
            .perChunk = samplesPerChunk(settings, kit_.input.device.info().software()),
            .directApart = directApart(settings),
            .directCost = kSegmentCost * (emitters_.rays(0) + lamps_.rays()),
            .linkCost = kit_.linksOfSamplePass * linkShare,
            .passCost = kSegmentCost * (kit_.wide() ? kPassRaysOnGpu : kPassRaysOnCpu)};
}

void LinkSolver::step() {
    if (done_) return;
    const vk::MemoryOwner owner(kLinksOwner);
    const auto start = Clock::now();
    if (state_.stage == Stage::Plan) plan();
    if (state_.stage == Stage::Direct)
        directBatch();
    else if (state_.stage == Stage::Links)
        linkBatch();
    progress_.passFraction = 1.0 - static_cast<double>(kit_.order.left()) / std::max(1u, kit_.order.count());
    progress_.seconds += secondsSince(start);
}

void LinkSolver::begin(Stage stage) {
    state_.stage = stage;
    state_.bounce = 0;
    const bool apart = stage == Stage::Direct && state_.apart.on;
    pass_ = samplePassesOf(stage).next(apart ? kMostTogether : 1);
    if (stage == Stage::Links && state_.scaled)
        pass_ = linkSamplePasses_.next(
            std::min(batches_.mostSamplePasses(), schedule_.samplePassesAtOnce(pass_.first)));
    state_.passSamplePasses = pass_.count;
    if (stage == Stage::Links) {
        batches_.cache().forget();
        return beginBounce();
    }
    beginOrder();
    const bool forgets = kit_.buffers.notes && pass_.first == 0;
    if (!forgets && !kit_.settings.live) return; // a submit takes as long as a short pass
    VkCommandBuffer cmd = kit_.commands.begin();
    if (forgets) vkCmdFillBuffer(cmd, kit_.buffers.notes.handle(), 0, VK_WHOLE_SIZE, 0);
    recordUndo(cmd);
    vk::barrier(cmd);
    kit_.commands.run();
}

// This process does its own chunks of the pass.
void LinkSolver::beginOrder() {
    if (!kit_.rankChunks.alone())
        kit_.order.beginMarked(kit_.rankChunks.ownOf(pass_.chunks), seenOfStage());
    else if (pass_.all)
        kit_.order.begin(chunksOfStage(), seenOfStage());
    else
        kit_.order.beginMarked(pass_.chunks, seenOfStage());
}

// Takes note of the pass that has ended.
void LinkSolver::endPass() {
    ChunkSamplePasses& samplePasses = samplePassesOf(state_.stage);
    samplePasses.finish(pass_);
    if (state_.stage == Stage::Links)
        state_.linkSamplePasses = samplePasses.deepest();
    else
        state_.directSamplePasses = state_.apart.on ? samplePasses.shallowest() : samplePasses.deepest();
    if (state_.scaled) uploadScales();
    stale_ = true;
    state_.stage = Stage::Plan;
}

const std::vector<uint8_t>& LinkSolver::seenOfStage() const {
    return state_.stage == Stage::Links && coarse_.count > 0 ? seenReceivers_ : kit_.seen;
}

// Direct light is every patch's own; links may start at fewer.
uint32_t LinkSolver::chunksOfStage() const {
    return state_.stage == Stage::Links ? senders_.chunks() : kit_.chunkCount();
}

void LinkSolver::traceDirect(const DirectPortion& portion, SamplePasses samplePasses, DirectSubmit& submit) {
    const auto trace = [&](auto& lights, uint32_t group, SamplePasses atOnce) {
        traceGroup(lights,
                   {.group = group,
                    .samplePass = atOnce.first / atOnce.count,
                    .together = atOnce.count,
                    .range = portion.range,
                    .chunks = portion.chunks},
                   submit);
    };
    const uint32_t end = samplePasses.first + samplePasses.count;
    for (SamplePasses next{samplePasses.first, 0}; next.first < end; next.first += next.count) {
        next.count = samplePassesAtOnce(next.first, end - next.first);
        if (emitters_.rays(0) > 0) trace(emitters_, 0, next);
        for (uint32_t group = 0; group < lamps_.groups(); ++group)
            trace(lamps_, group, next);
    }
}

template<typename Lights>
void LinkSolver::traceGroup(Lights& lights, typename Lights::Work work, DirectSubmit& submit) {
    const LightBuffers& light = kit_.input.light;
    const LinkBuffers& buffers = kit_.buffers;
    bool onCpu = kit_.tracesOnCpu() && lights.onCpu(work.group);
    if constexpr (requires { work.notes; }) {
        work.notes = buffers.notes ? &buffers.notes : nullptr;
        work.soFar = &buffers.direct;
        onCpu = onCpu && !work.notes;
    }
    // The device's kernels take longer on a CPU than code of its own, which knows neither the sky nor picks
    // nor notes.
    if (onCpu)
        return submit.note(lights.traceOnCpu(light, work,
                                             {.pool = kit_.gatherPass.pool(),
                                              .tracer = kit_.input.tracer,
                                              .rays = buffers.rays,
                                              .sums = buffers.directSums,
                                              .direct = buffers.direct}));
    const PointTracer on{kit_.commands, kit_.timestamps, kit_.input.tracer};
    const SegmentWork segments = lights.segments(light, work, buffers.rays);
    const auto samples = [&](VkCommandBuffer to) { lights.recordSamples(to, light, work); };
    const auto gather = [&](VkCommandBuffer to) {
        lights.recordGather(to, light, work, buffers.directSums, buffers.direct);
    };
    if (!submit.records()) return submit.note(tracePoints(on, segments, samples, gather));
    const uint32_t mark = submit.nextMark(); // may begin other commands
    recordPoints(submit.commands(), on, segments, samples, gather, mark);
}

// A rank may have no chunk in a pass. Where a tracer records, portions follow each other in one submit: one
// of them alone is too short for a large GPU.
void LinkSolver::directBatch() {
    const uint64_t before = progress_.rays; // those of a pass are counted with its last portion
    if (kit_.order.left() > 0) {
        const uint32_t batch = std::min(kit_.buffers.batchChunks, emitters_.batchChunks());
        const uint32_t most = lamps_.empty() ? batch : std::min(batch, lamps_.batchChunks());
        directPortions_.begin(pass_, most);
        const auto start = Clock::now();
        DirectSubmit submit(kit_);
        do {
            const DirectPortion portion = directPortions_.next();
            traceDirect(portion, {pass_.first, pass_.count}, submit);
            // All chunks take part until there is a solution, so portions are ranges of them.
            if (kit_.settings.live && !schedule_.hasSolution(state_)) live_.ranges.push_back(portion.range);
        } while (submit.goesOn() && directPortions_.wantsMore());
        submit.finish(kit_.order.left() == 0);
        directPortions_.end(secondsSince(start));
    }
    if (kit_.order.left() > 0) return;
    // Ranks wait for each other only where they must: places cost unlike, which evens out from pass to pass.
    if (pass_.all || !state_.apart.on) {
        const uint64_t rays = kit_.input.ranks.sum(progress_.rays - before);
        const uint64_t chunks = std::count(pass_.chunks.begin(), pass_.chunks.end(), 1);
        state_.raysToLights = static_cast<double>(rays) / static_cast<double>(chunks * kChunk * pass_.count);
    }
    endPass();
}

// Makes what links read: radiance of patches and, where they have footprints, of nodes, which need that of
// all ranks.
void LinkSolver::recordRadiance(VkCommandBuffer cmd) {
    radiancePass_.record(cmd, kit_.input.light, kit_.settings.transport, kit_.rankChunks.own());
    vk::barrier(cmd);
    if (kit_.rankChunks.alone() || !footprints_) recordReadable(cmd, kit_, footprints_);
}

// Brings what other ranks' patches send, packed where links read it so.
void LinkSolver::shareRadiance() {
    if (kit_.rankChunks.alone()) return;
    const bool packed = kit_.buffers.packed && !footprints_;
    if (packed) return kit_.rankChunks.share({kit_.buffers.packed, kChunk * sizeof(glm::uvec2)});
    kit_.rankChunks.share({kit_.input.light.radiance, kChunk * sizeof(glm::vec4)});
    if (!footprints_) return;
    VkCommandBuffer cmd = kit_.commands.begin();
    recordReadable(cmd, kit_, footprints_);
    kit_.run(cmd);
}

// Begins a bounce; `sent` says that what patches send is there.
void LinkSolver::beginBounce(bool sent) {
    const LinkBuffers& buffers = kit_.buffers;
    state_.last = schedule_.isLastBounce(state_);
    if (!sent || kit_.settings.live) {
        VkCommandBuffer cmd = kit_.commands.begin();
        if (state_.last) recordUndo(cmd);
        if (state_.bounce == 0) {
            const std::span<const ChunkRange> own = kit_.rankChunks.own();
            const uint32_t samples =
                kit_.settings.passes > 0 ? 0 : state_.linkSamplePasses * kit_.linksOfSamplePass;
            if (buffers.carried && samples > 0 && !state_.scaled)
                kit_.gatherPass.recordCarry(cmd, kit_.input.light, buffers, direct(), 0.0f, own);
            else
                kit_.gatherPass.recordCompose(cmd, kit_.input.light, buffers, direct(), samples, scales(),
                                              own);
            vk::barrier(cmd);
        }
        if (!sent) recordRadiance(cmd);
        if (buffers.coarseSums) vkCmdFillBuffer(cmd, buffers.coarseSums.handle(), 0, VK_WHOLE_SIZE, 0);
        kit_.run(cmd);
    }
    shareRadiance();
    beginOrder();
    if (!schedule_.hasSolution(state_)) {
        live_.all = true;
        live_.ranges.clear();
    }
}

// Mostly links are there from the sample pass's second bounce on; after a restore they are traced once more.
void LinkSolver::linkBatch() {
    if (kit_.order.left() == 0) return endBounce(); // a rank may have no chunk
    using Portions = std::vector<LinkBatches::Portion>;
    Portions portions =
        state_.scaled ? Portions{batches_.takeOnce(pass_.first, pass_.count)} : batches_.take(pass_.first);
    for (LinkBatches::Portion& portion : portions)
        complete(portion);
    const bool traces = portions.front().trace, atOnce = batches_.onCpu() && !footprints_;
    const auto recordDistances = [&](VkCommandBuffer cmd) {
        if (!wantsDistances()) return;
        for (const LinkBatches::Portion& portion : portions)
            kit_.gatherPass.recordDistances(cmd, kit_.input.light, kit_.buffers, portion.gather);
    };
    batches_.run(portions,
                 {.begin = {},
                  .traced =
                      [&](VkCommandBuffer cmd) {
                          if (traces && footprints_)
                              recordFootprints(cmd, kit_, *footprints_, portions,
                                               schedule_.footprintSamples(state_));
                      },
                  .gather =
                      [&](VkCommandBuffer cmd) {
                          for (const LinkBatches::Portion& portion : portions)
                              kit_.gatherPass.record(cmd, kit_.input.light, kit_.buffers, portion.gather);
                          if (!atOnce) recordDistances(cmd);
                      },
                  .endRecords = [&] { return wantsDistances(); },
                  .end =
                      [&](VkCommandBuffer cmd) {
                          if (atOnce) recordDistances(cmd);
                      }},
                 atOnce);
    for (const LinkBatches::Portion& portion : portions) {
        const uint64_t count = senders_.count(portion.range) * kit_.linksOfSamplePass * portion.samplePasses;
        (traces ? progress_.rays : progress_.raysSaved) += count;
        progress_.pairs += count;
        if (kit_.settings.live && !schedule_.hasSolution(state_) && coarse_.count == 0)
            live_.ranges.push_back(portion.range);
    }
    batches_.finish(pass_.first, portions);
    if (kit_.order.left() == 0) endBounce();
}

// Says where a portion's links start, and what is gathered over them.
void LinkSolver::complete(LinkBatches::Portion& portion) const {
    const bool coarse = coarse_.count > 0;
    portion.closest.receivers = coarse ? &kit_.buffers.receivers : nullptr;
    portion.closest.receiversHost = coarse ? coarse_.receivers.data() : nullptr;
    portion.closest.disc = disc_.points ? &disc_.points : nullptr;
    portion.closest.discCount = disc_.count;
    portion.gather.nodes = footprints_ ? footprints_->nodes() : 0;
    portion.gather.sky = sky_;
    portion.gather.direct = direct();
    portion.gather.accumulate = state_.last;
    portion.gather.output = !state_.scaled; // what goes on comes of the sums then
}

// Interpolates from the receivers of the coarser grid to all patches.
void LinkSolver::interpolate() {
    const uint32_t chunks = kit_.chunkCount();
    for (uint32_t first = 0; first < chunks; first += kInterpolatedChunks) {
        VkCommandBuffer cmd = kit_.commands.begin();
        kit_.gatherPass.recordInterpolate(cmd, kit_.input.light, kit_.buffers,
                                          {.samples = kit_.linksOfSamplePass,
                                           .direct = direct(),
                                           .accumulate = state_.last,
                                           .distances = wantsDistances(),
                                           .range = {first, std::min(kInterpolatedChunks, chunks - first)}});
        vk::barrier(cmd);
        kit_.commands.run();
    }
}

// Lets the next sample pass start from this one's light, too. Where chunks have sample passes of their own,
// the next one starts from the mean of all.
void LinkSolver::carry() {
    if (!kit_.buffers.carried || state_.scaled) return;
    VkCommandBuffer cmd = kit_.commands.begin();
    kit_.gatherPass.recordCarry(cmd, kit_.input.light, kit_.buffers, direct(),
                                carriedShare(state_.linkSamplePasses + 1), kit_.rankChunks.own());
    kit_.run(cmd);
}

void LinkSolver::endBounce() {
    if (coarse_.count > 0) interpolate();
    kit_.shareCounters();
    ++progress_.passes;
    const bool converges = schedule_.converges(state_);
    if (converges) {
        const bool isFirst = state_.bounce == 0;
        const glm::dvec4 total =
            sendsOnHost_ ? errors_.sendOnHost(senders_.full(), isFirst) : errors_.change(isFirst);
        const double mean = state_.series.learn(total, isFirst);
        if (isFirst) state_.convergence.add(total.w / std::max(1.0, 3.0 * total.z));
        state_.convergence.add(mean);
    }
    if (state_.last) carry();
    kit_.input.light.turn();
    ++state_.bounce;
    if (!state_.last) {
        if (converges) state_.last = schedule_.hasConverged(state_);
        return beginBounce(converges && sendsOnHost_);
    }
    if (kit_.settings.passes == 0) {
        state_.series.error *= state_.series.ratio; // this bounce's own share
        if (state_.linkSamplePasses == 0)
            state_.convergence.bounce();
        else
            state_.convergence.samplePass(state_.linkSamplePasses);
    } else
        state_.series.error = 0; // what more bounces would add is not asked for
    endPass();
    const double links = static_cast<double>(linkSamplePasses_.total()) * kit_.linksOfSamplePass;
    progress_.samples = static_cast<uint32_t>(std::lround(links / linkSamplePasses_.done().size()));
}

} // namespace relume
