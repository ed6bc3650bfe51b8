#include "bake/links/direct_portions.h"

#include "bake/direct/point_trace.h"

#include <algorithm>
#include <bit>

namespace relume {
namespace {

// A submit goes on with another portion where it lacks this share of one: shorter ones fill a GPU less and
// trace slower (the town by a seventh).
constexpr double kLeastPortion = 0.5;
// Fewer listed chunks keep the threads of a CPU waiting. A viewer would wait for so many of several sample
// passes.
constexpr double kFewestListed = 8;

// Returns the most sample passes that are made at once.
uint32_t mostAtOnce(const ChunkSamplePasses::Pass& pass) {
    uint32_t most = 1;
    for (uint32_t i = 0, count; i < pass.count; i += count) {
        count = samplePassesAtOnce(pass.first + i, pass.count - i);
        most = std::max(most, count);
    }
    return most;
}

} // namespace

uint32_t samplePassesAtOnce(uint32_t first, uint32_t left) {
    ASSERT(left > 0);
    uint32_t count = std::bit_floor(std::min(left, kMostTogether));
    while (first % count != 0)
        count /= 2;
    return count;
}

void DirectPortions::begin(const ChunkSamplePasses::Pass& pass, uint32_t most) {
    neighbours_ = pass.all && kit_.rankChunks.alone();
    samplePasses_ = pass.count;
    most_ = std::max(1u, most / mostAtOnce(pass));
    wanted_ = rate_.wanted(kit_.batchMs);
    done_ = 0;
    listed_ = 0;
}

DirectPortion DirectPortions::next() {
    DirectPortion portion;
    if (neighbours_) {
        portion.range = kit_.nextRange(rate_, most_, samplePasses_);
        kit_.order.finish(portion.range);
    } else
        portion = list(mostListed());
    done_ += static_cast<double>(portion.range.count) * samplePasses_;
    return portion;
}

uint32_t DirectPortions::mostListed() const {
    const double fewest = kit_.settings.live ? 1.0 : kFewestListed;
    return std::min(most_, static_cast<uint32_t>(std::max(fewest, (wanted_ - done_) / samplePasses_)));
}

DirectPortion DirectPortions::list(uint32_t most) {
    if (!list_)
        list_ = vk::Buffer(kit_.input.device, {.size = kit_.chunkCount() * sizeof(uint32_t),
                                               .memory = vk::Memory::Host,
                                               .name = "listed chunks"});
    const std::vector<uint32_t> chunks = kit_.order.nextOnes(most);
    kit_.order.finish(chunks);
    std::copy(chunks.begin(), chunks.end(), list_.as<uint32_t>() + listed_);
    const ChunkRange range{listed_, static_cast<uint32_t>(chunks.size())};
    listed_ += range.count;
    return {range, &list_};
}

bool DirectPortions::wantsMore() const {
    return kit_.order.left() > 0 && done_ + kLeastPortion * most_ * samplePasses_ < wanted_;
}

} // namespace relume
