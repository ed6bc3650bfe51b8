#include "bake/pairs/pair_solver.h"

#include "assets/base/clock.h"
#include "assets/base/log.h"
#include "bake/base/finite_light.h"
#include "bake/base/series.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;
using shader::kRayCounters;
using shader::kSuperBlocks;

// The first batch of a bake traces so many units, not measured yet: it surely takes less than 50 ms.
constexpr uint32_t kFirstUnits = 16;
// A batch may grow this much over the one before: a first measurement may have caught shader compilation.
constexpr double kMaxGrowth = 4.0;
// One thread sums up the change of so many patches at a time.
constexpr uint32_t kMeasured = 1u << 16;
// Each analytic light that has an extent gets so many rays per patch and sample pass: few enough for a batch
// to be short.
constexpr uint32_t kLampRays = 16;

} // namespace

uint64_t PairSolver::bytes(uint32_t chunkCount, bool software, const SolverSettings& settings) {
    const bool list = settings.method != Method::Pure;
    const uint64_t supers =
        PairPlan::superBlocks({.rows = chunkCount, .columns = chunkCount, .symmetric = !list});
    const uint64_t patches = uint64_t{chunkCount} * kChunk;
    const uint64_t window = settings.method == Method::Adaptive ? 1 : settings.pairs.window;
    constexpr uint64_t kSender =
        sizeof(shader::Patch) + sizeof(shader::PatchEdges) + sizeof(shader::Sender) + sizeof(glm::vec4);
    const uint64_t senders = list ? patches / (window * window) * kSender + patches * sizeof(uint32_t) : 0;
    const uint64_t live = settings.live ? patches * sizeof(glm::vec4) : 0;
    const uint64_t lamps =
        patches * sizeof(glm::vec4) * (shader::kReplicates + 1) + LampLight::bytes(chunkCount, software);
    // On a software device the host's copy of the senders counts, too.
    return PairBuffers::bytes(supers, software) + senders * (software ? 2 : 1) + live + lamps;
}

PairSolver::PairSolver(const SolverInput& input, const SolverSettings& settings)
    : device_(input.device), patches_(input.patches), light_(input.light), tracer_(input.tracer),
      settings_(settings), senders_(input, settings),
      lamps_(device_, settings.transport.rtrad ? Scene{} : input.scene, patches_, {.samples = kLampRays}),
      bothEnds_(settings.transport.rtrad && senders_.kind() == SenderKind::Patches), radiancePass_(device_),
      gatherPass_(device_, senders_.kind(), settings.transport), finishPass_(device_), commands_(device_),
      timestamps_(device_, 3), rows_(PairPlan::superCount(patches_.chunkCount())) {
    batchMs_ = settings.batchMs;
    makeCache();
    const PairPlan::Desc most{.rows = patches_.chunkCount(),
                              .columns = senders_.maxColumns(),
                              .symmetric = senders_.kind() == SenderKind::Patches};
    buffers_ = PairBuffers(device_, PairPlan::superBlocks(most), senders_.kind());
    rays_ = vk::Buffer(device_, {.size = 2 * kRayCounters * sizeof(uint32_t), .name = "ray counters"});
    makeLamps();
    if (settings.transport.rtrad && !(input.scene.lights.empty() && !input.scene.sky.shines()))
        spdlog::warn("the preset rtrad knows emissive materials only: {} lights are left out",
                     input.scene.lights.size() + (input.scene.sky.shines() ? 1 : 0));

    // RTRad starts from the emission itself, the lighting of the others from nothing.
    last_.assign(patches_.scene.patches.size(), glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    if (settings.transport.rtrad) {
        for (size_t i = 0; i < last_.size(); ++i)
            last_[i] = glm::vec4(glm::vec3(patches_.emission[i]), 1.0f);
    }
    before_ = last_;
    state_.threshold = settings_.pairs.threshold;
    vk::upload(device_, light_.ligIn, last_.data(), LightBuffers::lightBytes(patches_));
    vk::upload(device_, light_.ligOut, last_.data(), LightBuffers::lightBytes(patches_));
    fresh_.assign(PairPlan::superCount(patches_.chunkCount()), Fresh::LigIn);
    if (settings_.live)
        live_ = vk::Buffer(device_, {.size = LightBuffers::lightBytes(patches_), .name = "live light"});
}

void PairSolver::makeCache() {
    using Kind = CacheSettings::Kind;
    const CacheSettings& wanted = settings_.cache;
    if (wanted.kind == Kind::None || wanted.kind == Kind::Links || settings_.passes == 1) return;
    const uint64_t slot = superBytes(bothEnds_);
    const uint64_t limit = wanted.bytes;
    if (limit < slot) {
        spdlog::warn(
            "visibility cache: {} bytes do not hold one super-block ({} KiB): everything is traced in "
            "every pass",
            limit, slot >> 10);
        return;
    }
    const PairPlan::Desc most{.rows = patches_.chunkCount(),
                              .columns = senders_.maxColumns(),
                              .symmetric = senders_.kind() == SenderKind::Patches};
    cache_ = std::make_unique<BitsCache>(
        device_, BitsCache::Desc{.slotBytes = slot, .slots = PairPlan::superBlocks(most), .maxBytes = limit});
}

void PairSolver::step() {
    if (done_) return;
    const auto start = Clock::now();
    if (!lampsDone()) {
        lampBatch();
        progress_.seconds += secondsSince(start);
        return;
    }
    if (!state_.inPass) beginPass();
    Batch batch = cutBatch();
    if (!batch.supers.empty()) run(batch);
    if (plan_.unitCount() > 0)
        progress_.passFraction = static_cast<double>(unitsDone_) / static_cast<double>(plan_.unitCount());
    const bool passEnds = passDone();
    if (passEnds) endPass();
    progress_.seconds += secondsSince(start);
    if (passEnds) {
        const double before =
            std::accumulate(progress_.passSeconds.begin(), progress_.passSeconds.end(), 0.0);
        progress_.passSeconds.push_back(progress_.seconds - before);
    }
}

void PairSolver::beginPass() {
    VkCommandBuffer cmd = commands_.begin();
    if (lamps_.empty())
        vkCmdFillBuffer(cmd, light_.ligOut.handle(), 0, VK_WHOLE_SIZE, 0);
    else
        recordCopy(cmd, direct_, light_.ligOut, {{0, patches_.chunkCount()}});
    vkCmdFillBuffer(cmd, rays_.handle(), 0, VK_WHOLE_SIZE, 0);
    radiancePass_.record(cmd, light_, settings_.transport);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    state_.inPass = true;
    state_.ringTurn = 0;
    listSupers();
    rows_.begin(plan_.superRows(), seenRows_);
    nextRow();
}

// Lists what the pass goes through, which follows from the light it starts from.
void PairSolver::listSupers() {
    senders_.prepare(last_, state_.threshold);
    if (cache_) keptRays_ *= cache_->forgetColumns(senders_.changed());
    plan_ = PairPlan({.rows = patches_.chunkCount(),
                      .columns = senders_.columns(),
                      .symmetric = senders_.kind() == SenderKind::Patches},
                     senders_.sends());
    unitsDone_ = unitsKnown_ = 0;
    progress_.passFraction = 0;
}

void PairSolver::nextSuper() {
    state_.unit = 0;
    do
        ++state_.column;
    while (state_.column < plan_.superColumns() && isDone(state_.column));
    if (state_.column < plan_.superColumns()) return;
    rows_.finish({state_.row, 1});
    // RTRad adds emission to the light only at the pass' end.
    if (!settings_.transport.rtrad) fresh_[state_.row] = Fresh::LigOut;
    nextRow();
}

void PairSolver::nextRow() {
    state_.row = rows_.left() > 0 ? rows_.next(1, 0).first : plan_.superRows();
    state_.column = firstColumn();
    state_.unit = 0;
}

// Returns the first column of a row that has not begun.
uint32_t PairSolver::firstColumn() const {
    uint32_t column = 0;
    while (column < plan_.superColumns() && isDone(column))
        ++column;
    return column;
}

// Tells whether the row of the patches that send in a column had its super-blocks before.
bool PairSolver::isDone(uint32_t column) const {
    return plan_.symmetric() && !rows_.isLeft(column);
}

SuperBlock PairSolver::current() const {
    const bool turned = plan_.symmetric() && state_.column < state_.row;
    return {.row = turned ? state_.column : state_.row, .column = turned ? state_.row : state_.column};
}

// Cuts a batch; super-blocks in which nobody sends are left out.
PairSolver::Batch PairSolver::cutBatch() {
    Batch batch;
    batch.firstUnit = state_.unit;
    while (!passDone() && batch.supers.size() < buffers_.capacity && batch.cost < batchMs_) {
        const SuperBlock next = current();
        const UnitMask units = plan_.units(next.row, next.column);
        if (units.count() == 0) {
            nextSuper();
            continue;
        }
        if (!addSuper(batch, units)) break;
        // One is enough to learn what gathering costs.
        if (msPerGathered_ == 0.0) break;
    }
    return batch;
}

// Adds the current super-block; returns false when only a part of it fits.
bool PairSolver::addSuper(Batch& batch, const UnitMask& units) {
    const SuperBlock super = current();
    BitsCache::Entry* entry = cache_ ? cache_->find(super.row, super.column) : nullptr;
    if (!entry && !ring_.bits) ring_ = BitsRing(device_, buffers_.capacity, superBytes(bothEnds_));
    const UnitMask known = entry ? entry->known : UnitMask{};
    if (state_.unit == 0) superKnown_ = units.within(known).count();
    const uint64_t slot = state_.ringTurn % buffers_.capacity;
    batch.supers.push_back({.row = super.row,
                            .column = super.column,
                            .bits = entry ? entry->address : ring_.address(slot),
                            .known0 = known.lo,
                            .known1 = known.hi,
                            .counters = entry ? 0 : kRayCounters});
    batch.bits.push_back(entry ? entry->host : ring_.host(slot));
    batch.entries.push_back(entry);
    const UnitMask left = UnitMask::range(state_.unit, kSuperBlocks);
    const UnitMask missing = units.without(known).within(left);
    const uint32_t end = unitsThatFit(batch, missing);
    const UnitMask traced = missing.within(UnitMask::range(0, end));
    batch.traced.push_back(traced);
    batch.tracedUnits += traced.count();
    batch.cost += traced.count() * msPerTraced_;
    batch.endUnit = static_cast<uint32_t>(batch.supers.size() - 1) * kSuperBlocks + end;
    if (end < kSuperBlocks) {
        state_.unit = end;
        return false;
    }
    unitsDone_ += units.count();
    unitsKnown_ += superKnown_;
    batch.gatheredUnits += units.count();
    batch.cost += units.count() * msPerGathered_;
    batch.pairs += plan_.pairs(super.row, super.column);
    ++batch.complete;
    if (!entry) ++state_.ringTurn;
    nextSuper();
    return true;
}

// Returns up to which unit of the super-block just added the batch goes; it always goes some further.
uint32_t PairSolver::unitsThatFit(const Batch& batch, const UnitMask& missing) const {
    const double room =
        msPerTraced_ > 0 ? (batchMs_ - batch.cost) / msPerTraced_ : kFirstUnits - batch.tracedUnits;
    auto fits = static_cast<uint32_t>(std::clamp(room, batch.tracedUnits > 0 ? 0.0 : 1.0, 256.0));
    if (missing.count() <= fits) return kSuperBlocks;
    uint32_t unit = state_.unit;
    for (; fits > 0; ++unit)
        if (missing.has(unit)) --fits;
    return unit;
}

void PairSolver::run(Batch& batch) {
    const auto start = Clock::now();
    VkCommandBuffer cmd = commands_.begin();
    vkCmdUpdateBuffer(cmd, buffers_.supers.handle(), 0, batch.supers.size() * sizeof(SuperBlock),
                      batch.supers.data());
    vk::barrier(cmd);
    timestamps_.reset(cmd);
    timestamps_.mark(cmd, 0);
    if (batch.tracedUnits > 0) trace(cmd, batch);
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
                                 .supers = std::span(batch.supers).first(batch.complete),
                                 .bits = std::span(batch.bits).first(batch.complete),
                                 .window = senders_.skippedWindow(),
                                 .size = patches_.scene.size,
                                 .transport = settings_.transport});
        vk::barrier(cmd);
    }
    timestamps_.mark(cmd, 2);
    vk::hostBarrier(cmd);
    commands_.run();
    for (size_t s = 0; s < batch.supers.size(); ++s)
        if (batch.entries[s]) batch.entries[s]->known = batch.entries[s]->known.with(batch.traced[s]);
    const double traced = tracer_.onCpu() ? cpuTrace : 1e-3 * timestamps_.milliseconds(0, 1);
    const double gathered = 1e-3 * timestamps_.milliseconds(1, 2);
    progress_.traceSeconds += batch.tracedUnits > 0 ? traced : 0.0;
    progress_.gatherSeconds += gathered;
    progress_.pairs += batch.pairs;
    // The rest of the time, which the submit itself takes, is shared out between both.
    const double wall = secondsSince(start), scale = wall / std::max(1e-9, traced + gathered);
    learn(batch, 1000.0 * traced * scale, 1000.0 * gathered * scale);
}

void PairSolver::trace(VkCommandBuffer cmd, const Batch& batch) {
    OcclusionWork work{.supers = batch.supers,
                       .superBuffer = &buffers_.supers,
                       .bits = batch.bits,
                       .firstUnit = batch.firstUnit,
                       .unitCount = batch.endUnit - batch.firstUnit,
                       .sends = &senders_.sendsBuffer(),
                       .senders = senders_.runs(),
                       .rays = &rays_};
    tracer_.occlusion(cmd, work);
    if (!bothEnds_) return;
    work.reversed = true;
    tracer_.occlusion(cmd, work);
}

void PairSolver::learn(const Batch& batch, double traceMs, double gatherMs) {
    const auto update = [](double& known, double measured) {
        known = known > 0 ? std::max(measured, known / kMaxGrowth) : measured;
    };
    constexpr double kLeast = 1e-6; // [ms], so that 0 stays "unknown"
    if (batch.tracedUnits > 0) update(msPerTraced_, std::max(kLeast, traceMs / batch.tracedUnits));
    if (batch.gatheredUnits > 0) update(msPerGathered_, std::max(kLeast, gatherMs / batch.gatheredUnits));
}

uint64_t PairSolver::countedRays(uint32_t half) {
    const auto counters = vk::readBuffer<uint32_t>(device_, rays_, kRayCounters, size_t{half} * kRayCounters);
    return std::accumulate(counters.begin(), counters.end(), uint64_t{0});
}

uint64_t PairSolver::raysSoFar() {
    return state_.inPass ? progress_.rays + countedRays(0) + countedRays(1) : progress_.rays;
}

void PairSolver::countRays() {
    progress_.rays = raysSoFar();
    keptRays_ += static_cast<double>(countedRays(0));
}

void PairSolver::endPass() {
    VkCommandBuffer cmd = commands_.begin();
    finishPass_.record(cmd, light_, settings_.transport.rtrad);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    if (unitsKnown_ > 0) progress_.raysSaved += static_cast<uint64_t>(keptRays_);
    countRays();
    progress_.cacheBytes = cache_ ? cache_->bytes() : 0;
    progress_.cachedShare =
        unitsDone_ > 0 ? static_cast<double>(unitsKnown_) / static_cast<double>(unitsDone_) : 0.0;
    progress_.passes = ++state_.passes;
    progress_.passFraction = 0;
    std::swap(last_, before_);
    vk::download(device_, light_.ligOut, last_.data(), last_.size() * sizeof(glm::vec4));
    measureChange();
    std::swap(light_.ligIn, light_.ligOut);
    for (Fresh& fresh : fresh_)
        if (fresh != Fresh::No || settings_.transport.rtrad) fresh = Fresh::LigIn;
    state_.threshold *= settings_.pairs.thresholdRamp;
    state_.inPass = false;

    progress_.converged = settings_.error > 0 && progress_.passes >= 2 && progress_.error <= settings_.error;
    const bool allPasses = settings_.passes > 0 && progress_.passes >= settings_.passes;
    done_ = progress_.converged || allPasses || progress_.passes >= kMaxPasses;
}

void PairSolver::measureChange() {
    const auto pieces = static_cast<uint32_t>((patches_.count + kMeasured - 1) / kMeasured);
    std::vector<ChangeSums> parts(pieces);
    pool_.run(pieces, [&](uint32_t k) { parts[k] = changeOf(k * kMeasured); });
    ChangeSums all;
    for (const ChangeSums& part : parts) {
        all.squares += part.squares;
        all.light += part.light;
        all.count += part.count;
    }
    const double change = all.count > 0 ? std::sqrt(all.squares / static_cast<double>(all.count)) : 0.0;
    const double mean = all.count > 0 ? all.light / static_cast<double>(all.count) : 0.0;
    requireFiniteLight(mean, change);
    if (const std::optional<SeriesRest> rest = seriesRest(state_.lastChange, change, mean)) {
        progress_.error = rest->error;
        left_ = static_cast<float>(rest->ratio < 1.0 ? rest->ratio / (1.0 - rest->ratio) : 1.0);
    }
    state_.lastChange = change;
    // RTRad's light has the emission in it from the start.
    if (progress_.passes == 1 && !settings_.transport.rtrad) state_.settling.add(0.0);
    state_.settling.add(mean);
}

// Sums up the change of the patches from `first` on.
PairSolver::ChangeSums PairSolver::changeOf(uint32_t first) const {
    ChangeSums sums;
    for (uint32_t i = first; i < std::min(first + kMeasured, patches_.count); ++i) {
        const uint32_t flags = patches_.scene.patches[i].flags;
        if (!shader::patchIsShown(flags)) continue;
        const glm::dvec3 change = glm::dvec3(last_[i]) - glm::dvec3(before_[i]);
        sums.squares += glm::dot(change, change);
        sums.light += double{last_[i].r} + last_[i].g + last_[i].b;
        sums.count += 3;
    }
    return sums;
}

std::vector<float> PairSolver::errors() {
    std::vector<float> errors(left_ >= 0 ? last_.size() : 0);
    for (size_t i = 0; i < errors.size(); ++i)
        errors[i] = left_ * glm::length(glm::vec3(last_[i] - before_[i])) / std::sqrt(3.0f);
    return errors;
}

SolverState PairSolver::state() {
    ASSERT(!done_);
    PairState atBorder = state_;
    atBorder.unit = 0; // bits of a part of a super-block are traced again
    return makeState(atBorder);
}

std::vector<StatePart> PairSolver::stateParts() {
    std::vector<StatePart> parts = {part(device_, light_.ligIn), part(device_, light_.ligOut),
                                    part(device_, rays_), part(rows_)};
    if (!lamps_.empty()) {
        parts.push_back(part(device_, lampSums_));
        parts.push_back(part(device_, direct_));
    }
    return parts;
}

void PairSolver::restore(const SolverState& state) {
    state_ = takeState<PairState>(state);
    done_ = false;
    last_ = vk::readBuffer<glm::vec4>(device_, light_.ligIn, patches_.scene.patches.size());
    before_ = last_;
    left_ = -1;
    fresh_.assign(fresh_.size(), Fresh::LigIn);
    complete_ = false;
    if (!state_.inPass) return;
    rows_.restore(PairPlan::superCount(patches_.chunkCount()), seenRows_);
    for (uint32_t row = 0; row < fresh_.size() && !settings_.transport.rtrad; ++row)
        if (!rows_.isLeft(row)) fresh_[row] = Fresh::LigOut;
    VkCommandBuffer cmd = commands_.begin();
    radiancePass_.record(cmd, light_, settings_.transport);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    listSupers();
}

} // namespace relume
