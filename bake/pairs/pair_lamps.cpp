#include "bake/pairs/pair_lamps.h"

#include <algorithm>

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

PairLamps::PairLamps(const vk::Device& device, const Scene& scene, const PatchSet& patches)
    : chunks_(patches.chunkCount()), lamps_(device, scene, patches, {.samples = kPairLampRays}) {
    if (empty()) return;
    const uint64_t bytes = LightBuffers::lightBytes(patches);
    sums_ = vk::Buffer(device, {.size = shader::kReplicates * bytes, .name = "lamp sums"});
    direct_ = vk::Buffer(device, {.size = bytes, .name = "direct light"});
}

bool PairLamps::done() const {
    return empty() || place_.samplePasses == kSamplePasses;
}

double PairLamps::fraction() const {
    return (place_.samplePasses + static_cast<double>(place_.chunk) / chunks_) / kSamplePasses;
}

void PairLamps::clear(vk::Commands& commands) {
    place_ = {};
    VkCommandBuffer cmd = commands.begin();
    vkCmdFillBuffer(cmd, sums_.handle(), 0, VK_WHOLE_SIZE, 0);
    vkCmdFillBuffer(cmd, direct_.handle(), 0, VK_WHOLE_SIZE, 0);
    vk::barrier(cmd);
    commands.run();
}

PointTimes PairLamps::batch(const Batch& batch) {
    const auto start = Clock::now();
    const uint32_t left = chunks_ - place_.chunk;
    const double wanted = rate_ > 0 ? rate_ * batch.aim : kFirstChunks;
    const auto count = static_cast<uint32_t>(
        std::clamp(wanted, 1.0, static_cast<double>(std::min(left, lamps_.batchChunks()))));
    PointTimes all;
    for (uint32_t group = 0; group < lamps_.groups(); ++group) {
        const LampLight::Work work{
            .group = group, .samplePass = place_.samplePasses, .range = {place_.chunk, count}};
        const PointTimes times = tracePoints(
            batch.on, lamps_.segments(batch.light, work, batch.rays),
            [&](VkCommandBuffer cmd) { lamps_.recordSamples(cmd, batch.light, work); },
            [&](VkCommandBuffer cmd) { lamps_.recordGather(cmd, batch.light, work, sums_, direct_); });
        all.trace += times.trace;
        all.gather += times.gather;
    }
    rate_ = count / std::max(1e-3, 1e3 * secondsSince(start));
    place_.chunk += count;
    if (place_.chunk == chunks_) place_ = {.samplePasses = place_.samplePasses + 1, .chunk = 0};
    return all;
}

} // namespace relume
