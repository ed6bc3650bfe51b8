#include "bake/gather/link_kit.h"

#include "bake/base/shader_types.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace relume {

LinkKit::LinkKit(const SolverInput& from, const Desc& desc)
    : input(from), settings(desc.settings), linksOfSamplePass(desc.linksOfSamplePass),
      buffers(from.device, from.patches, desc.buffers), rankChunks(from.device, from.ranks, from.patches),
      gatherPass(from.device, settings.transport), commands(from.device),
      timestamps(from.device, 3 * kMostPortions), order(desc.chunks), progress(desc.progress),
      batchMs(desc.batchMs) {}

ChunkRange LinkKit::nextRange(const BatchRate& rate, uint32_t most, double cost, double done) const {
    const double limit =
        std::clamp((rate.wanted(batchMs) - done) / cost, 1.0, std::max(1.0, static_cast<double>(most)));
    return order.next(static_cast<uint32_t>(limit),
                      static_cast<uint32_t>(rate.perMs() / cost * kWorthASubmit));
}

HostSmoothing LinkKit::smoothing(double sigma, bool smooths) const {
    const auto width = static_cast<float>(sigma);
    return {.patches = input.light.patches.as<shader::Patch>(),
            .patchChart = buffers.patchChart.as<uint32_t>(),
            .texelToPatch = buffers.texelToPatch.as<uint32_t>(),
            .distances = smooths ? buffers.distances.as<glm::vec2>() : nullptr,
            .sums = buffers.linkSums.as<glm::vec4>(),
            .rows = smooths ? buffers.rows.as<glm::vec4>() : nullptr,
            .size = buffers.size,
            .chunkCount = chunkCount(),
            .reach = smooths ? smoothingReach(width) : 0,
            .sigma = width};
}

void LinkKit::reserveBack(VkDeviceSize bytes) {
    if (back_ && back_.size() >= bytes) return;
    back_ = vk::Buffer(input.device, {.size = bytes, .memory = vk::Memory::Host, .name = "sums for the CPU"});
}

void LinkKit::recordBack(VkCommandBuffer cmd, const vk::Buffer& from, VkDeviceSize bytes, VkDeviceSize at) {
    ASSERT(at + bytes <= back_.size());
    vk::barrier(cmd);
    const VkBufferCopy all{0, at, bytes};
    vkCmdCopyBuffer(cmd, from.handle(), back_.handle(), 1, &all);
}

void LinkKit::run(VkCommandBuffer cmd) {
    run(cmd, {});
}

void LinkKit::run(VkCommandBuffer cmd, const std::function<void()>& meanwhile) {
    vk::barrier(cmd);
    vk::hostBarrier(cmd);
    const uint64_t value = commands.submit();
    try {
        if (meanwhile) meanwhile();
    } catch (...) {
        commands.wait(value); // the caller lets go of what the device works with
        throw;
    }
    commands.wait(value);
}

void LinkKit::recordRayCount(VkCommandBuffer cmd) {
    recordBack(cmd, buffers.rays, buffers.rays.size());
    vk::barrier(cmd);
    vkCmdFillBuffer(cmd, buffers.rays.handle(), 0, VK_WHOLE_SIZE, 0);
}

void LinkKit::countRays() {
    const auto* counters = back<uint32_t>(0, shader::kRayCounters);
    progress.rays = std::accumulate(counters, counters + shader::kRayCounters, progress.rays);
}

void LinkKit::shareCounters() {
    if (rankChunks.alone()) return;
    std::array<uint64_t, 3> gained = {progress.rays - sharedRays_, progress.raysSaved - sharedSaved_,
                                      progress.pairs - sharedPairs_};
    input.ranks.sum(gained);
    progress.rays = sharedRays_ + gained[0];
    progress.raysSaved = sharedSaved_ + gained[1];
    progress.pairs = sharedPairs_ + gained[2];
    noteCounters();
}

void LinkKit::noteCounters() {
    sharedRays_ = progress.rays;
    sharedSaved_ = progress.raysSaved;
    sharedPairs_ = progress.pairs;
}

} // namespace relume
