// This part of PairSolver makes the direct light of analytic lights, which no patch sends. It is found once,
// before the first pass, and each pass adds to it.
#include "bake/pairs/pair_solver.h"

#include "assets/base/clock.h"
#include "bake/direct/point_trace.h"

#include <algorithm>

namespace relume {
namespace {

// So many sample passes find the light of each analytic light that has an extent: beside what pairs of
// patches cost, they cost next to nothing.
constexpr uint32_t kRounds = 16;
// The first batch has so many chunks, before anything is measured.
constexpr double kFirstChunks = 4;

} // namespace

void PairSolver::makeLamps() {
    if (lamps_.empty()) return;
    const uint64_t bytes = LightBuffers::lightBytes(patches_);
    lampSums_ = vk::Buffer(device_, {.size = shader::kReplicates * bytes, .name = "lamp sums"});
    direct_ = vk::Buffer(device_, {.size = bytes, .name = "direct light"});
    clearCounters();
    clearLamps();
}

void PairSolver::clearLamps() {
    state_.lampRounds = state_.lampChunk = 0;
    VkCommandBuffer cmd = commands_.begin();
    vkCmdFillBuffer(cmd, lampSums_.handle(), 0, VK_WHOLE_SIZE, 0);
    vkCmdFillBuffer(cmd, direct_.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    commands_.run();
}

// Clears the counters of rays; rays so far are noted before.
void PairSolver::clearCounters() {
    VkCommandBuffer cmd = commands_.begin();
    vkCmdFillBuffer(cmd, rays_.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    commands_.run();
}

bool PairSolver::lampsDone() const {
    return lamps_.empty() || state_.lampRounds == kRounds;
}

void PairSolver::lampBatch() {
    const auto start = Clock::now();
    const uint32_t left = patches_.chunkCount() - state_.lampChunk;
    const double wanted = lampRate_ > 0 ? lampRate_ * batchMs_ : kFirstChunks;
    const auto count = static_cast<uint32_t>(
        std::clamp(wanted, 1.0, static_cast<double>(std::min(left, lamps_.batchChunks()))));
    const PointTracer on{commands_, timestamps_, tracer_};
    for (uint32_t group = 0; group < lamps_.groups(); ++group) {
        const LampLight::Work work{
            .group = group, .round = state_.lampRounds, .range = {state_.lampChunk, count}};
        const PointTimes times = tracePoints(
            on, lamps_.segments(work, rays_),
            [&](VkCommandBuffer cmd) { lamps_.recordSamples(cmd, light_, work); },
            [&](VkCommandBuffer cmd) { lamps_.recordGather(cmd, light_, work, lampSums_, direct_); });
        progress_.traceSeconds += times.trace;
        progress_.gatherSeconds += times.gather;
    }
    lampRate_ = count / std::max(1e-3, 1e3 * secondsSince(start));
    state_.lampChunk += count;
    const double done = state_.lampRounds + static_cast<double>(state_.lampChunk) / patches_.chunkCount();
    progress_.passFraction = done / kRounds;
    if (state_.lampChunk < patches_.chunkCount()) return;
    state_.lampChunk = 0;
    if (++state_.lampRounds < kRounds) return;
    progress_.passFraction = 0;
    progress_.rays = raysSoFar();
    clearCounters();
}

} // namespace relume
