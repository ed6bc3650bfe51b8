// This part of PairSolver answers what a viewer asks.
#include "bake/pairs/pair_solver.h"

#include "assets/base/error.h"

#include <algorithm>

namespace relume {

using shader::kSuper;

void PairSolver::setPriority(std::vector<uint8_t> chunkSeen) {
    ASSERT(chunkSeen.empty() || chunkSeen.size() == patches_.chunkCount());
    seenRows_.assign(chunkSeen.empty() ? 0 : PairPlan::superCount(patches_.chunkCount()), 0);
    for (size_t chunk = 0; chunk < chunkSeen.size(); ++chunk)
        if (chunkSeen[chunk] != 0) seenRows_[chunk / kSuper] = 1;
    if (!state_.inPass) return;
    rows_.prefer(seenRows_);
    const bool begun = state_.unit > 0 || state_.column != firstColumn();
    if (!begun) nextRow();
}

// Rows that are through may show the pass under way: they have all of its light.
LiveLight PairSolver::liveLight() {
    ASSERT(settings_.live);
    std::vector<ChunkRange> fromIn, fromOut;
    for (uint32_t row = 0; row < fresh_.size(); ++row) {
        if (fresh_[row] == Fresh::No) continue;
        const uint32_t first = row * kSuper;
        const ChunkRange chunks{first, std::min(kSuper, patches_.chunkCount() - first)};
        (fresh_[row] == Fresh::LigIn ? fromIn : fromOut).push_back(chunks);
        fresh_[row] = Fresh::No;
    }
    std::vector<ChunkRange> changed = fromIn;
    changed.insert(changed.end(), fromOut.begin(), fromOut.end());
    if (!changed.empty()) {
        ++liveVersion_;
        VkCommandBuffer cmd = commands_.begin();
        recordCopy(cmd, light_.ligIn, live_, merged(std::move(fromIn)));
        recordCopy(cmd, light_.ligOut, live_, merged(std::move(fromOut)));
        vk::barrier(cmd);
        commands_.run();
    }
    complete_ = complete_ || done_ || state_.settling.left <= kMostDimmer;
    return {&live_, liveVersion_, complete_, merged(std::move(changed))};
}

// Bits that are kept stay when a pass is aborted.
void PairSolver::abortPass() {
    if (passBoundary()) return;
    countRays();
    progress_.passFraction = 0;
    if (!lampsDone()) {
        clearCounters();
        clearLamps();
        return;
    }
    state_.inPass = false;
    fresh_.assign(fresh_.size(), Fresh::LigIn);
}

} // namespace relume
