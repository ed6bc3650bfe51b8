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
                     std::vector<uint32_t> chunks)
    : allChunks_(patches.chunkCount()), chunks_(std::move(chunks)),
      lamps_(device, scene, patches, {.samples = kPairLampRays}) {
    if (empty()) return;
    const uint64_t bytes = LightBuffers::lightBytes(patches);
    sums_ = vk::Buffer(device, {.size = shader::kReplicates * bytes, .name = "lamp sums"});
    direct_ = vk::Buffer(device, {.size = bytes, .name = "direct light"});
    if (chunks_.empty() || chunks_.size() == allChunks_) return;
    list_ = vk::Buffer(
        device,
        {.size = chunks_.size() * sizeof(uint32_t), .memory = vk::Memory::Host, .name = "listed chunks"});
    std::copy(chunks_.begin(), chunks_.end(), list_.as<uint32_t>());
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

// Returns the chunks of the sample pass that are left, by their numbers in chunks_.
ChunkRange PairLamps::next() const {
    const auto first = std::lower_bound(chunks_.begin(), chunks_.end(), place_.chunk);
    return {static_cast<uint32_t>(first - chunks_.begin()), static_cast<uint32_t>(chunks_.end() - first)};
}

PointTimes PairLamps::batch(const Batch& batch) {
    const auto start = Clock::now();
    ChunkRange range = next();
    const double wanted = rate_ > 0 ? rate_ * batch.aim : kFirstChunks;
    const uint32_t most = std::min(range.count, lamps_.batchChunks());
    range.count =
        std::min(most, static_cast<uint32_t>(std::clamp(wanted, 1.0, static_cast<double>(most) + 1.0)));
    PointTimes all;
    for (uint32_t group = 0; group < lamps_.groups() && range.count > 0; ++group) {
        const LampLight::Work work{.group = group,
                                   .samplePass = place_.samplePasses,
                                   .range = range,
                                   .chunks = list_ ? &list_ : nullptr};
        const PointTimes times = tracePoints(
            batch.on, lamps_.segments(batch.light, work, batch.rays),
            [&](VkCommandBuffer cmd) { lamps_.recordSamples(cmd, batch.light, work); },
            [&](VkCommandBuffer cmd) { lamps_.recordGather(cmd, batch.light, work, sums_, direct_); });
        all.trace += times.trace;
        all.gather += times.gather;
    }
    if (range.count > 0) {
        rate_ = range.count / std::max(1e-3, 1e3 * secondsSince(start));
        place_.chunk = chunks_[range.first + range.count - 1] + 1;
    }
    if (next().count == 0) place_ = {.samplePasses = place_.samplePasses + 1, .chunk = 0};
    return all;
}

} // namespace relume
