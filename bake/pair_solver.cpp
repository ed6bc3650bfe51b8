#include "bake/pair_solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace relume {
namespace {

using Clock = std::chrono::steady_clock;
using shader::kChunk;
using shader::kSuper;
using shader::kSuperBlocks;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// The first batch of a bake, before anything is measured: surely below 50 ms.
constexpr uint32_t kFirstUnits = 16;
// A batch may grow this much over the one before: a first measurement may have caught shader compilation.
constexpr double kMaxGrowth = 4.0;

uint32_t superRows(uint32_t chunkCount) {
    return (chunkCount + kSuper - 1) / kSuper;
}

} // namespace

uint64_t PairSolver::bytes(uint32_t chunkCount, bool software) {
    const uint64_t rows = superRows(chunkCount);
    return PairBuffers::bytes(rows * (rows + 1) / 2, software);
}

void PairSolver::checkPairs(const PatchSet& patches) {
    const uint64_t rows = superRows(patches.chunkCount());
    constexpr uint64_t kMaxRows = 5791; // whose units can still be numbered by 32 bits
    if (rows > kMaxRows) {
        const double fits =
            patches.scene.size * std::sqrt(static_cast<double>(kMaxRows) / static_cast<double>(rows));
        throw Error("pure method: the pairs of " + std::to_string(patches.count) +
                    " patches are too many: --size " + std::to_string(static_cast<uint32_t>(fits) / 64 * 64) +
                    " fits");
    }
}

PairSolver::PairSolver(const SolverInput& input, const SolverSettings& settings)
    : device_(input.device), patches_(input.patches), light_(input.light), tracer_(input.tracer),
      settings_(settings), radiancePass_(device_), gatherPass_(device_, settings.transport.rtrad),
      finishPass_(device_), commands_(device_), timestamps_(device_, 3) {
    checkPairs(patches_);
    const uint64_t rows = superRows(patches_.chunkCount());
    pairs_ = PairBuffers(device_, rows * (rows + 1) / 2, settings.transport.rtrad);
    rays_ = vk::Buffer(device_, {.size = shader::kRayCounters * sizeof(uint32_t), .name = "ray counters"});

    // RTRad starts from the emission itself, lighting from nothing.
    last_.assign(patches_.scene.patches.size(), glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    if (settings.transport.rtrad) {
        for (size_t i = 0; i < last_.size(); ++i)
            last_[i] = glm::vec4(glm::vec3(patches_.emission[i]), 1.0f);
    }
    vk::upload(device_, light_.ligIn, last_.data(), LightBuffers::lightBytes(patches_));
    vk::upload(device_, light_.ligOut, last_.data(), LightBuffers::lightBytes(patches_));
}

void PairSolver::step() {
    if (done_) return;
    const auto start = Clock::now();
    if (!inPass_) beginPass();
    const auto unitCount = static_cast<uint32_t>(supers_.size()) * kSuperBlocks;
    if (nextUnit_ < unitCount) {
        const double wanted = unitsPerMs_ > 0 ? unitsPerMs_ * settings_.batchMs : kFirstUnits;
        // Bits of a super-block that is only partly traced stay until the rest has come.
        const uint32_t room = nextUnit_ / kSuperBlocks * kSuperBlocks + pairs_.bitsUnits - nextUnit_;
        const Portion portion = cutPortion(wanted, std::min(room, unitCount - nextUnit_));
        const auto batchStart = Clock::now();
        traceBatch(portion.units);
        const double rate = std::max(1.0, portion.busy) / std::max(1e-3, 1000.0 * secondsSince(batchStart));
        unitsPerMs_ = unitsPerMs_ > 0 ? std::min(rate, kMaxGrowth * unitsPerMs_) : rate;
        progress_.passFraction = static_cast<double>(nextUnit_) / unitCount;
    }
    const bool passEnds = nextUnit_ >= unitCount;
    if (passEnds) endPass();
    progress_.seconds += secondsSince(start);
    if (passEnds) {
        const double before =
            std::accumulate(progress_.passSeconds.begin(), progress_.passSeconds.end(), 0.0);
        progress_.passSeconds.push_back(progress_.seconds - before);
    }
}

// So many units that about `wanted` of them have a sender: the others cost next to nothing.
PairSolver::Portion PairSolver::cutPortion(double wanted, uint32_t most) const {
    Portion portion;
    while (portion.units < most && portion.busy < wanted) {
        const uint32_t unit = nextUnit_ + portion.units, left = kSuperBlocks - unit % kSuperBlocks;
        const double share = busyShare_[unit / kSuperBlocks];
        const double missing = std::max(1.0, std::ceil((wanted - portion.busy) / share));
        const uint32_t take =
            std::min(most - portion.units, static_cast<uint32_t>(std::min<double>(left, missing)));
        portion.units += take;
        portion.busy += take * share;
    }
    return portion;
}

void PairSolver::beginPass() {
    VkCommandBuffer cmd = commands_.begin();
    vkCmdFillBuffer(cmd, light_.ligOut.handle(), 0, VK_WHOLE_SIZE, 0);
    vkCmdFillBuffer(cmd, rays_.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    commands_.run();
    listSupers();
    nextUnit_ = 0;
    inPass_ = true;
    progress_.passFraction = 0;
}

// What ligIn makes of the pass.
void PairSolver::listSupers() {
    VkCommandBuffer cmd = commands_.begin();
    radiancePass_.record(cmd, light_, settings_.transport);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();

    // Pairs of super-rows in which somebody sends, row by row.
    const auto sends = vk::readBuffer<uint32_t>(device_, light_.chunkSends, patches_.chunkCount());
    const uint32_t rows = superRows(patches_.chunkCount());
    std::vector<uint32_t> sending(rows, 0); // chunks of each row
    for (uint32_t chunk = 0; chunk < sends.size(); ++chunk)
        sending[chunk / kSuper] += sends[chunk] != 0;
    supers_.clear();
    busyShare_.clear();
    for (uint32_t row = 0; row < rows; ++row) {
        for (uint32_t column = row; column < rows; ++column) {
            if (sending[row] + sending[column] == 0) continue;
            supers_.push_back({row, column});
            const double silent = static_cast<double>(kSuper - sending[row]) * (kSuper - sending[column]);
            busyShare_.push_back(static_cast<float>(1.0 - silent / kSuperBlocks));
        }
    }
    if (!supers_.empty())
        vk::upload(device_, pairs_.supers, supers_.data(), supers_.size() * sizeof(SuperBlock));
}

void PairSolver::traceBatch(uint32_t unitCount) {
    const uint32_t chunkCount = patches_.chunkCount();
    const uint32_t firstSuper = nextUnit_ / kSuperBlocks, endSuper = (nextUnit_ + unitCount) / kSuperBlocks;
    OcclusionWork work{.supers = &pairs_.supers,
                       .chunkSends = &light_.chunkSends,
                       .firstUnit = nextUnit_,
                       .unitCount = unitCount,
                       .bits = &pairs_.bits,
                       .bitsUnits = pairs_.bitsUnits,
                       .rays = &rays_};
    const auto start = Clock::now();
    VkCommandBuffer cmd = commands_.begin();
    timestamps_.reset(cmd);
    timestamps_.mark(cmd, 0);
    tracer_.occlusion(cmd, work);
    if (pairs_.reversed) {
        work.bits = &pairs_.reversed;
        work.reversed = true;
        tracer_.occlusion(cmd, work);
    }
    const double cpuTrace = secondsSince(start);
    vk::barrier(cmd);
    timestamps_.mark(cmd, 1);
    if (endSuper > firstSuper) {
        gatherPass_.record(cmd, light_, pairs_, {firstSuper, endSuper - firstSuper}, settings_.transport);
        vk::barrier(cmd);
    }
    timestamps_.mark(cmd, 2);
    vk::hostBarrier(cmd);
    commands_.run();
    nextUnit_ += unitCount;
    progress_.traceSeconds += tracer_.onCpu() ? cpuTrace : 1e-3 * timestamps_.milliseconds(0, 1);
    progress_.gatherSeconds += 1e-3 * timestamps_.milliseconds(1, 2);
    for (uint32_t s = firstSuper; s < endSuper; ++s) {
        const auto patchesOf = [&](uint32_t row) {
            return uint64_t{std::min(kSuper, chunkCount - row * kSuper)} * kChunk;
        };
        const uint64_t pairs = patchesOf(supers_[s].row) * patchesOf(supers_[s].column);
        progress_.pairs += supers_[s].row == supers_[s].column ? pairs : 2 * pairs;
    }
}

// Bits of a super-block that is only partly traced are traced again.
SolverState PairSolver::state() {
    ASSERT(!done_);
    return makeState(State{inPass_, nextUnit_ / kSuperBlocks * kSuperBlocks, lastChange_});
}

std::vector<StatePart> PairSolver::stateParts() {
    return {part(device_, light_.ligIn), part(device_, light_.ligOut), part(device_, rays_)};
}

void PairSolver::restore(const SolverState& state) {
    const State own = takeState<State>(state);
    done_ = false;
    inPass_ = own.inPass;
    lastChange_ = own.lastChange;
    last_ = vk::readBuffer<glm::vec4>(device_, light_.ligIn, patches_.scene.patches.size());
    errors_.clear();
    if (!inPass_) return;
    listSupers();
    nextUnit_ = own.nextUnit;
}

uint64_t PairSolver::raysSoFar() {
    if (!inPass_) return progress_.rays;
    const auto counters = vk::readBuffer<uint32_t>(device_, rays_, shader::kRayCounters);
    return std::accumulate(counters.begin(), counters.end(), progress_.rays);
}

void PairSolver::endPass() {
    VkCommandBuffer cmd = commands_.begin();
    finishPass_.record(cmd, light_, settings_.transport.rtrad);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
    progress_.rays = raysSoFar();
    ++progress_.passes;
    progress_.passFraction = 0;
    measureChange(vk::readBuffer<glm::vec4>(device_, light_.ligOut, patches_.scene.patches.size()));
    std::swap(light_.ligIn, light_.ligOut);
    inPass_ = false;

    progress_.converged = settings_.error > 0 && progress_.passes >= 2 && progress_.error <= settings_.error;
    const bool allPasses = settings_.passes > 0 && progress_.passes >= settings_.passes;
    done_ = progress_.converged || allPasses || progress_.passes >= kMaxPasses;
}

// The remaining error of a geometric series: change * q / (1 - q), q being the ratio of the last two changes,
// relative to the mean (conventions.md, Errors).
void PairSolver::measureChange(const std::vector<glm::vec4>& now) {
    double squares = 0, sum = 0;
    uint64_t count = 0;
    for (size_t i = 0; i < patches_.count; ++i) {
        const uint32_t flags = patches_.scene.patches[i].flags;
        if ((flags & shader::kPatchSends) == 0 || (flags & shader::kPatchBackSide) != 0) continue;
        const glm::dvec3 change = glm::dvec3(now[i]) - glm::dvec3(last_[i]);
        squares += glm::dot(change, change);
        sum += double{now[i].r} + now[i].g + now[i].b;
        count += 3;
    }
    const std::vector<glm::vec4> before = std::exchange(last_, now);
    const double change = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
    const double mean = count > 0 ? sum / static_cast<double>(count) : 0.0;
    if (change == 0.0 || mean <= 0.0) {
        progress_.error = 0.0;
    } else if (lastChange_ > 0.0) {
        const double q = change / lastChange_;
        progress_.error = q < 1.0 ? change * q / (1.0 - q) / mean : 1.0;
        const auto left = static_cast<float>(q < 1.0 ? q / (1.0 - q) : 1.0);
        errors_.resize(now.size());
        for (size_t i = 0; i < now.size(); ++i)
            errors_[i] = left * glm::length(glm::vec3(now[i] - before[i])) / std::sqrt(3.0f);
    }
    lastChange_ = change;
}

} // namespace relume
