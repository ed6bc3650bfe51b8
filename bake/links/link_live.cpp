// This part of LinkSolver answers what a viewer asks.
#include "bake/links/link_solver.h"

#include "assets/base/error.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;

// Results are made for the viewer's eyes at most as often as a display shows them, and so that they take no
// more than this share of the time.
constexpr double kLookSeconds = 1.0 / 60.0, kLookShare = 0.1;

} // namespace

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
    const uint32_t rounds = state_.rounds();
    if (!stale_ || !schedule_.hasSolution(state_) || !live_.asked || rounds == live_.rounds) return;
    const double pause = std::max(kLookSeconds, live_.cost / kLookShare);
    if (live_.resolves > 0 && secondsSince(live_.looked) < pause) return;
    live_.looked = Clock::now();
    const LinkState before = state_;
    SmoothingWidth width = live_.width.value_or(state_.width);
    const shader::ResolveSums sums = errors_.resolve(state_, kit_.buffers.rows ? width.sigma : 0.0);
    learn(sums);
    if (kit_.buffers.rows) width.adapt(sums);
    live_.width = width;
    state_ = before;
    live_.cost = secondsSince(live_.looked);
    live_.rounds = rounds;
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
    return {&kit_.buffers.result, live_.version, live_.complete || done_, std::move(changed)};
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
        kit_.gatherPass.recordDirectMean(cmd, kit_.input.light, kit_.buffers, state_.directRounds, scales());
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
        const auto counters =
            vk::readBuffer<uint32_t>(kit_.input.device, kit_.buffers.rays, shader::kRayCounters);
        progress_.rays = std::accumulate(counters.begin(), counters.end(), progress_.rays);
    } else if (state_.linkRounds == 0) { // convergence begins anew
        state_.series = {};
        state_.settling = {};
    }
    progress_.passes -= state_.bounce;
    progress_.passFraction = 0;
    state_.stage = Stage::Plan;
    state_.bounce = 0;
    live_.all = true;
    live_.ranges.clear();
}

} // namespace relume
