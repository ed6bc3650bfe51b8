#include "bake/pairs/pair_view.h"

#include <algorithm>
#include <utility>

#include "bake/pairs/pair_plan.h"

namespace relume {

using shader::kSuper;

FreshRows::FreshRows(uint32_t chunks) : chunks_(chunks), rows_(PairPlan::superCount(chunks), Fresh::LigIn) {}

void FreshRows::startOver() {
    std::fill(rows_.begin(), rows_.end(), Fresh::LigIn);
}

void FreshRows::endPass(bool all) {
    for (Fresh& fresh : rows_)
        if (fresh != Fresh::No || all) fresh = Fresh::LigIn;
}

FreshRows::Chunks FreshRows::take() {
    Chunks chunks;
    for (uint32_t row = 0; row < rows_.size(); ++row) {
        const Fresh fresh = std::exchange(rows_[row], Fresh::No);
        if (fresh == Fresh::No) continue;
        const uint32_t first = row * kSuper;
        (fresh == Fresh::LigIn ? chunks.fromLast : chunks.fromPass)
            .push_back({first, std::min(kSuper, chunks_ - first)});
    }
    return {merged(std::move(chunks.fromLast)), merged(std::move(chunks.fromPass))};
}

PairView::PairView(const vk::Device& device, const PatchSet& patches, bool live)
    : rows_(patches.chunkCount()) {
    if (live) light_ = vk::Buffer(device, {.size = LightBuffers::lightBytes(patches), .name = "live light"});
}

LiveLight PairView::look(vk::Commands& commands, const LightBuffers& light, bool complete) {
    FreshRows::Chunks fresh = rows_.take();
    std::vector<ChunkRange> changed = fresh.fromLast;
    changed.insert(changed.end(), fresh.fromPass.begin(), fresh.fromPass.end());
    if (!changed.empty()) {
        ++version_;
        VkCommandBuffer cmd = commands.begin();
        recordCopy(cmd, light.ligIn, light_, fresh.fromLast);
        recordCopy(cmd, light.ligOut, light_, fresh.fromPass);
        vk::barrier(cmd);
        commands.run();
    }
    complete_ = complete_ || complete;
    return {
        .light = &light_, .version = version_, .complete = complete_, .changed = merged(std::move(changed))};
}

void PairView::startOver() {
    rows_.startOver();
    complete_ = false;
}

} // namespace relume
