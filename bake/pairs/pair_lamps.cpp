#include "bake/pairs/pair_lamps.h"

#include <algorithm>
#include <utility>

#include "assets/base/clock.h"
#include "bake/pairs/pair_memory.h"

namespace relume {
namespace {

// So many sample passes find the light of each analytic light that has an extent: beside what pairs of
// patches cost, they cost next to nothing.
constexpr uint32_t kSamplePasses = 16;
// The first batch has so many chunks, before anything is measured.
constexpr double kFirstChunks = 4;

} // namespace

PairLamps::PairLamps(const vk::Device& device, const Scene& scene, const PatchSet& patches,
                     std::vector<ChunkRange> chunks)
    : allChunks_(patches.chunkCount()), chunks_(std::move(chunks)),
      lamps_(device, scene, patches, {.samples = kPairLampRays}) {
    if (empty()) return;
    const uint64_t bytes = LightBuffers::lightBytes(patches);
    sums_ = vk::Buffer(device, {.size = shader::kReplicates * bytes, .name = "lamp sums"});
    direct_ = vk::Buffer(device, {.size = bytes, .name = "direct light"});
}

bool PairLamps::done() const {
    return empty() || place_.samplePasses == kSamplePasses;
}

double PairLamps::fraction() const {
    return (place_.samplePasses + static_cast<double>(place_.chunk) / allChunks_) / kSamplePasses;
}

void PairLamps::clear(vk::Commands& commands) {
    place_ = {};
    VkCommandBuffer cmd = commands.begin();
    vkCmdFillBuffer(cmd, sums_.handle(), 0, VK_WHOLE_SIZE, 0);
    vkCmdFillBuffer(cmd, direct_.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    commands.run();
}

// Returns the next chunks of the sample pass, about so many; none where all are done.
ChunkRange PairLamps::next(double wanted) const {
    for (const ChunkRange& run : chunks_) {
        const uint32_t end = run.first + run.count;
        if (end <= place_.chunk) continue;
        const uint32_t first = std::max(run.first, place_.chunk);
        const uint32_t most = std::min(end - first, lamps_.batchChunks());
        return {first, static_cast<uint32_t>(std::clamp(wanted, 1.0, static_cast<double>(most)))};
    }
    return {allChunks_, 0};
}

PointTimes PairLamps::batch(const Batch& batch) {
    const auto start = Clock::now();
    const ChunkRange range = next(rate_ > 0 ? rate_ * batch.aim : kFirstChunks);
    PointTimes all;
    for (uint32_t group = 0; group < lamps_.groups() && range.count > 0; ++group) {
        const LampLight::Work work{.group = group, .samplePass = place_.samplePasses, .range = range};
        const PointTimes times = tracePoints(
            batch.on, lamps_.segments(batch.light, work, batch.rays),
            [&](VkCommandBuffer cmd) { lamps_.recordSamples(cmd, batch.light, work); },
            [&](VkCommandBuffer cmd) { lamps_.recordGather(cmd, batch.light, work, sums_, direct_); });
        all.trace += times.trace;
        all.gather += times.gather;
    }
    if (range.count > 0) rate_ = range.count / std::max(1e-3, 1e3 * secondsSince(start));
    place_.chunk = range.first + range.count;
    if (next(1).count == 0) place_ = {.samplePasses = place_.samplePasses + 1, .chunk = 0};
    return all;
}

} // namespace relume
