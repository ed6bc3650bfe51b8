#include "bake/pairs/pair_solver.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "assets/base/clock.h"
#include "assets/base/log.h"
#include "bake/pairs/pair_memory.h"

namespace relume {
namespace {

using shader::kRayCounters;
using shader::kSuper;

// RTRad starts from the emission itself, the lighting of the others from nothing.
std::vector<glm::vec4> startLight(const PatchSet& patches, bool rtrad) {
    std::vector<glm::vec4> light(patches.scene.patches.size(), glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    for (size_t i = 0; rtrad && i < light.size(); ++i)
        light[i] = glm::vec4(glm::vec3(patches.emission[i]), 1.0f);
    return light;
}

// Returns the memory that bits may be kept in; nothing where no later pass asks for them.
std::optional<uint64_t> cacheLimit(const SolverSettings& settings) {
    if (!settings.cache.keepsBits() || settings.passes == 1) return {};
    return settings.cache.bytes;
}

// Rows of super-blocks that belong together, of a rank. Visibility between rows of two ranks is traced by
// both, so nothing is gained by neighbours, and what rows cost is shared the better the more runs there are.
constexpr ChunkDeal::Runs kRowsOfRank{.least = 1, .most = 64};

// Returns the chunks of rows of super-blocks.
std::vector<uint32_t> chunksOf(std::span<const ChunkRange> rows, uint32_t chunkCount) {
    std::vector<uint32_t> chunks;
    for (const ChunkRange& run : rows)
        for (uint32_t chunk = run.first * kSuper;
             chunk < std::min((run.first + run.count) * kSuper, chunkCount); ++chunk)
            chunks.push_back(chunk);
    return chunks;
}

} // namespace

PairSolver::PairSolver(const SolverInput& input, const SolverSettings& settings)
    : device_(input.device), patches_(input.patches), light_(input.light), tracer_(input.tracer),
      settings_(settings), ranks_(input.ranks),
      deal_(PairPlan::superCount(patches_.chunkCount()), ranks_.count(), kRowsOfRank),
      senders_(input, settings), lamps_(device_, settings.transport.rtrad ? Scene{} : input.scene, patches_,
                                        chunksOf(deal_.runsOf(ranks_.rank()), patches_.chunkCount())),
      radiancePass_(device_), gatherPass_(device_, senders_.kind(), settings.transport), finishPass_(device_),
      commands_(device_), timestamps_(device_, 3),
      buffers_(device_, PairPlan::superBlocks(extent()), senders_.kind()),
      bits_(device_, {.slotBytes = superBytes(bothEnds()),
                      .supers = PairPlan::superBlocks(extent()),
                      .batch = buffers_.capacity,
                      .cacheBytes = cacheLimit(settings)}),
      rays_(device_, {.size = 2 * kRayCounters * sizeof(uint32_t), .name = "ray counters"}),
      walk_(patches_.chunkCount()),
      solved_(patches_, startLight(patches_, settings.transport.rtrad), !settings.transport.rtrad),
      view_(device_, patches_, settings.live), threshold_(settings.pairs.threshold) {
    batchMs_ = settings.batchMs;
    if (!lamps_.empty()) {
        clearCounters();
        lamps_.clear(commands_);
    }
    if (settings.transport.rtrad && !(input.scene.lights.empty() && !input.scene.sky.shines()))
        spdlog::warn("the preset rtrad knows emissive materials only: {} lights are left out",
                     input.scene.lights.size() + (input.scene.sky.shines() ? 1 : 0));
    vk::upload(device_, light_.ligIn, solved_.light().data(), LightBuffers::lightBytes(patches_));
    vk::upload(device_, light_.ligOut, solved_.light().data(), LightBuffers::lightBytes(patches_));
}

// Returns what a pass goes through at most.
PairPlan::Desc PairSolver::extent() const {
    PairPlan::Desc all{
        .rows = patches_.chunkCount(), .columns = senders_.maxColumns(), .symmetric = symmetric()};
    if (ranks_.alone()) return all;
    all.own.assign(deal_.chunks(), 0);
    for (const ChunkRange& run : deal_.runsOf(ranks_.rank()))
        std::fill_n(all.own.begin() + run.first, run.count, uint8_t{1});
    return all;
}

void PairSolver::step() {
    if (done_) return;
    const vk::MemoryOwner owner(kPairsOwner);
    const auto start = Clock::now();
    if (!lamps_.done()) {
        lampBatch();
        progress_.seconds += secondsSince(start);
        return;
    }
    if (!walk_.inPass()) beginPass();
    const PairBatch batch =
        cutPairBatch(walk_, tally_,
                     {.known = [this](uint32_t row, uint32_t column) { return bits_.known(row, column); },
                      .rates = rates_,
                      .aim = batchMs_,
                      .capacity = buffers_.capacity});
    // RTRad adds emission to the light only at the pass' end.
    if (!settings_.transport.rtrad)
        for (const uint32_t row : batch.rowsEnded)
            view_.rows().end(row);
    if (!batch.supers.empty()) run(batch);
    const uint64_t units = walk_.plan().unitCount();
    if (units > 0) progress_.passFraction = static_cast<double>(tally_.done) / static_cast<double>(units);
    const bool passEnds = walk_.through();
    if (passEnds) endPass();
    progress_.seconds += secondsSince(start);
    if (passEnds) {
        const double before =
            std::accumulate(progress_.passSeconds.begin(), progress_.passSeconds.end(), 0.0);
        progress_.passSeconds.push_back(progress_.seconds - before);
    }
}

void PairSolver::lampBatch() {
    const PointTimes times = lamps_.batch(
        {.on = {commands_, timestamps_, tracer_}, .light = light_, .rays = rays_, .aim = batchMs_});
    progress_.traceSeconds += times.trace;
    progress_.gatherSeconds += times.gather;
    progress_.passFraction = lamps_.done() ? 0.0 : lamps_.fraction();
    if (!lamps_.done()) return;
    progress_.rays += countedRays(0) + countedRays(1);
    shareCounters();
    shareRows(lamps_.direct());
    clearCounters();
}

void PairSolver::beginPass() {
    VkCommandBuffer cmd = commands_.begin();
    if (lamps_.empty())
        vkCmdFillBuffer(cmd, light_.ligOut.handle(), 0, VK_WHOLE_SIZE, 0);
    else
        recordCopy(cmd, lamps_.direct(), light_.ligOut, {{0, patches_.chunkCount()}});
    vkCmdFillBuffer(cmd, rays_.handle(), 0, VK_WHOLE_SIZE, 0);
    radiancePass_.record(cmd, light_, settings_.transport);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    bits_.beginPass();
    walk_.begin(plan());
}

// Plans what the pass goes through, which follows from the light that it starts from.
PairPlan PairSolver::plan() {
    senders_.prepare(solved_.light(), threshold_);
    bits_.forgetColumns(senders_.changed());
    tally_ = {};
    progress_.passFraction = 0;
    PairPlan::Desc pass = extent();
    pass.columns = senders_.columns();
    return {pass, senders_.sends()};
}

void PairSolver::run(const PairBatch& batch) {
    const PairBits::Places places = bits_.place(batch);
    const auto start = Clock::now();
    VkCommandBuffer cmd = commands_.begin();
    vkCmdUpdateBuffer(cmd, buffers_.supers.handle(), 0, places.supers.size() * sizeof(SuperBlock),
                      places.supers.data());
    vk::barrier(cmd);
    timestamps_.reset(cmd);
    timestamps_.mark(cmd, 0);
    if (batch.tracedUnits > 0) trace(cmd, batch, places);
    const double cpuTrace = secondsSince(start);
    vk::barrier(cmd);
    timestamps_.mark(cmd, 1);
    if (batch.complete > 0) {
        if (gatherPass_.onCpu()) { // which then counts into the time between the same two marks
            vk::hostBarrier(cmd);
            commands_.run();
            cmd = commands_.begin();
        }
        gatherPass_.record(cmd, {.light = light_,
                                 .pairs = buffers_,
                                 .senders = senders_.buffers(),
                                 .supers = std::span(places.supers).first(batch.complete),
                                 .bits = std::span(places.bits).first(batch.complete),
                                 .window = senders_.skippedWindow(),
                                 .size = patches_.scene.size,
                                 .transport = settings_.transport});
        vk::barrier(cmd);
    }
    timestamps_.mark(cmd, 2);
    vk::hostBarrier(cmd);
    commands_.run();
    PairBits::note(batch, places);
    const double traced = tracer_.onCpu() ? cpuTrace : 1e-3 * timestamps_.milliseconds(0, 1);
    const double gathered = 1e-3 * timestamps_.milliseconds(1, 2);
    progress_.traceSeconds += batch.tracedUnits > 0 ? traced : 0.0;
    progress_.gatherSeconds += gathered;
    progress_.pairs += batch.pairs;
    // The rest of the time, which the submit itself takes, is shared out between both.
    const double wall = secondsSince(start), scale = wall / std::max(1e-9, traced + gathered);
    rates_.learn(batch, 1000.0 * traced * scale, 1000.0 * gathered * scale);
}

void PairSolver::trace(VkCommandBuffer cmd, const PairBatch& batch, const PairBits::Places& places) {
    OcclusionWork work{.supers = places.supers,
                       .superBuffer = &buffers_.supers,
                       .bits = places.bits,
                       .firstUnit = batch.firstUnit,
                       .unitCount = batch.endUnit - batch.firstUnit,
                       .sends = &senders_.sendsBuffer(),
                       .senders = senders_.runs(),
                       .rays = &rays_};
    tracer_.occlusion(cmd, work);
    if (!bothEnds()) return;
    work.reversed = true;
    tracer_.occlusion(cmd, work);
}

void PairSolver::endPass() {
    shareRows(light_.ligOut);
    VkCommandBuffer cmd = commands_.begin();
    finishPass_.record(cmd, light_, settings_.transport.rtrad);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    if (tally_.known > 0) progress_.raysSaved += bits_.rays();
    countRays();
    shareCounters();
    progress_.cacheBytes = bits_.cacheBytes();
    progress_.cachedShare =
        tally_.done > 0 ? static_cast<double>(tally_.known) / static_cast<double>(tally_.done) : 0.0;
    ++progress_.passes;
    progress_.passFraction = 0;
    const std::optional<double> error = solved_.take(device_.workers(), [this](std::vector<glm::vec4>& to) {
        vk::download(device_, light_.ligOut, to.data(), to.size() * sizeof(glm::vec4));
    });
    if (error) progress_.error = *error;
    light_.turn();
    view_.rows().endPass(settings_.transport.rtrad);
    threshold_ *= settings_.pairs.thresholdRamp;
    walk_.leave();

    progress_.converged = settings_.error > 0 && progress_.passes >= 2 && progress_.error <= settings_.error;
    const bool allPasses = settings_.passes > 0 && progress_.passes >= settings_.passes;
    done_ = progress_.converged || allPasses || progress_.passes >= kMaxPasses;
}

// Brings to all ranks the light (vec4 per patch) of each one's rows.
void PairSolver::shareRows(const vk::Buffer& light) {
    if (ranks_.alone()) return;
    const VkDeviceSize bytes = LightBuffers::lightBytes(patches_);
    std::vector<glm::vec4> all(size_t{deal_.chunks()} * kSuper * shader::kChunk); // rows are whole here
    vk::download(device_, light, all.data(), bytes);
    shareChunks(ranks_, deal_, all);
    vk::upload(device_, light, all.data(), bytes);
}

// Rays between rows of two ranks are traced by both, and counted so.
void PairSolver::shareCounters() {
    if (ranks_.alone()) return;
    std::array<uint64_t, 3> gained = {progress_.rays - shared_.rays, progress_.raysSaved - shared_.saved,
                                      progress_.pairs - shared_.pairs};
    ranks_.sum(gained);
    progress_.rays = shared_.rays += gained[0];
    progress_.raysSaved = shared_.saved += gained[1];
    progress_.pairs = shared_.pairs += gained[2];
}

// Clears the counters of rays; rays so far are noted before.
void PairSolver::clearCounters() {
    VkCommandBuffer cmd = commands_.begin();
    vkCmdFillBuffer(cmd, rays_.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
}

uint64_t PairSolver::countedRays(uint32_t half) {
    const auto counters = vk::readBuffer<uint32_t>(device_, rays_, kRayCounters, size_t{half} * kRayCounters);
    return std::accumulate(counters.begin(), counters.end(), uint64_t{0});
}

uint64_t PairSolver::raysSoFar() {
    const bool underWay = walk_.inPass() || (lamps_.begun() && !lamps_.done());
    return underWay ? progress_.rays + countedRays(0) + countedRays(1) : progress_.rays;
}

void PairSolver::countRays() {
    progress_.rays = raysSoFar();
    bits_.addRays(countedRays(0));
}

SolverState PairSolver::state() {
    ASSERT(!done_);
    PairState state{.lampSamplePasses = lamps_.place().samplePasses,
                    .lampChunk = lamps_.place().chunk,
                    .passes = progress_.passes,
                    .inPass = walk_.inPass(),
                    .ringTurn = bits_.turn(),
                    .lastChange = solved_.state().lastChange,
                    .threshold = threshold_,
                    .convergence = solved_.state().convergence};
    if (state.inPass) { // bits of a part of a super-block are traced again
        state.row = walk_.place().row;
        state.column = walk_.place().column;
    }
    return makeState(state);
}

std::vector<StatePart> PairSolver::stateParts() {
    std::vector<StatePart> parts = {part(device_, light_.ligIn), part(device_, light_.ligOut),
                                    part(device_, rays_), part(walk_.rows())};
    if (!lamps_.empty()) {
        parts.push_back(part(device_, lamps_.sums()));
        parts.push_back(part(device_, lamps_.direct()));
    }
    return parts;
}

void PairSolver::restore(const SolverState& from) {
    const auto state = takeState<PairState>(from);
    done_ = false;
    lamps_.resume({.samplePasses = state.lampSamplePasses, .chunk = state.lampChunk});
    bits_.resume(state.ringTurn);
    threshold_ = state.threshold;
    solved_.restore({.lastChange = state.lastChange, .convergence = state.convergence},
                    vk::readBuffer<glm::vec4>(device_, light_.ligIn, patches_.scene.patches.size()));
    view_.startOver();
    walk_.leave();
    shared_ = {.rays = progress_.rays, .saved = progress_.raysSaved, .pairs = progress_.pairs};
    if (!ranks_.speaks()) clearCounters(); // what they count of the pass under way is the first rank's
    if (!state.inPass) return;
    VkCommandBuffer cmd = commands_.begin();
    radiancePass_.record(cmd, light_, settings_.transport);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    walk_.resume(plan(), {.row = state.row, .column = state.column});
    const uint32_t rows = walk_.plan().superRows();
    for (uint32_t row = 0; row < rows && !settings_.transport.rtrad; ++row)
        if (!walk_.isLeft(row)) view_.rows().end(row);
}

void PairSolver::setPriority(std::vector<uint8_t> chunkSeen) {
    ASSERT(chunkSeen.empty() || chunkSeen.size() == patches_.chunkCount());
    std::vector<uint8_t> rows(chunkSeen.empty() ? 0 : PairPlan::superCount(patches_.chunkCount()), 0);
    for (size_t chunk = 0; chunk < chunkSeen.size(); ++chunk)
        if (chunkSeen[chunk] != 0) rows[chunk / kSuper] = 1;
    walk_.prefer(std::move(rows));
}

// Rows that are through may show the pass under way: they have all of its light.
LiveLight PairSolver::liveLight() {
    ASSERT(settings_.live);
    return view_.look(commands_, light_, done_ || solved_.missing() <= kMostDimmer);
}

// Bits that are kept stay when a pass is aborted.
void PairSolver::abortPass() {
    if (passBoundary()) return;
    progress_.passFraction = 0;
    if (!lamps_.done()) {
        progress_.rays = raysSoFar();
        clearCounters();
        lamps_.clear(commands_);
        return;
    }
    countRays();
    walk_.leave();
    view_.rows().startOver();
}

} // namespace relume
