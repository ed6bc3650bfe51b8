#include "bake/gather/link_passes.h"

#include "bake/base/chunk_dispatch.h"
#include "bake/direct/emitter_light.h"
#include "bake/direct/lamp_light.h"
#include "bake/gather/host_links.h"
#include "bake/gather/link_cache.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;

// The rays of a sample pass should fill a GPU: 4M are a few milliseconds there.
constexpr uint32_t kGpuRays = 4u << 20;
constexpr uint32_t kLeastSamples = 16, kMostSamples = 64; // per patch and sample pass
// A submit has at most so many chunks.
constexpr uint32_t kGpuBatch = 8192, kSoftwareBatch = 512;

// Sums over a chunk, of either kind [bytes].
constexpr uint64_t kSumBytes = std::max(sizeof(shader::ResolveSums), sizeof(glm::vec4));

uint64_t vec4s(uint64_t count) {
    return count * sizeof(glm::vec4);
}

// Counts of light and errors, and sums per chunk.
uint64_t localBytes(uint64_t chunks) {
    return kLocalSumsAt + chunks * sizeof(shader::LocalSums);
}

} // namespace

uint32_t linkBatchChunks(uint32_t chunks, bool software) {
    return std::min(chunks, software ? kSoftwareBatch : kGpuBatch);
}

uint32_t linksOfSamplePass(uint32_t patches, uint32_t samples, bool software) {
    const uint32_t filling = software ? kLeastSamples : kGpuRays / std::max(patches, 1u);
    const uint32_t wanted = samples > 0 ? std::min(filling, samples) : filling;
    return std::bit_ceil(std::clamp(wanted, kLeastSamples, kMostSamples));
}

LinkBuffers::LinkBuffers(const vk::Device& device, const PatchSet& patches, const Desc& desc)
    : patchChart(vk::makeBuffer(device, patches.scene.patchChart, "chart of patch")),
      texelToPatch(vk::makeBuffer(device, patches.scene.texelToPatch, "texel to patch")) {
    const uint32_t chunks = patches.chunkCount();
    const uint64_t count = patches.scene.patches.size();
    if (desc.coarse) {
        receiverCount = static_cast<uint32_t>(desc.coarse->receivers.size());
        receivers = vk::makeBuffer(device, desc.coarse->receivers, "receivers");
        taps = vk::makeBuffer(device, desc.coarse->taps, "coarse taps");
        neighbours = vk::makeBuffer(device, desc.coarse->neighbours, "coarse neighbours");
        coarseSums = vk::Buffer(device, {.size = vec4s(kReplicates * receiverCount), .name = "coarse sums"});
    }
    batchChunks = linkBatchChunks(chunks, device.info().software());
    size = patches.scene.size;
    const auto spilled = [&](uint64_t bytes, Spill first, const char* name) {
        return vk::Buffer(device, {.size = bytes, .memory = memoryFrom(first, desc.spill), .name = name});
    };
    if (desc.direct) directSums = spilled(vec4s(kReplicates * count), Spill::Direct, "direct sums");
    linkSums = spilled(vec4s(kReplicates * count), Spill::Links, "link sums");
    direct = spilled(vec4s(count), Spill::Direct, "direct light");
    if (desc.carries) carried = spilled(vec4s(count), Spill::Links, "carried light");
    if (desc.notes)
        notes = vk::Buffer(device, {.size = chunks * sizeof(glm::uvec2), .name = "notes of lights"});
    if (desc.smooth) {
        rows = spilled(vec4s(kReplicates * count), Spill::Smoothing, "smoothed rows");
        distances = spilled(count * sizeof(glm::vec2), Spill::Smoothing, "link distances");
        if (desc.coarse)
            coarseDistances =
                vk::Buffer(device, {.size = receiverCount * sizeof(glm::vec2), .name = "coarse distances"});
    }
    result = spilled(vec4s(count), Spill::Smoothing, "result");
    chunkSums = vk::Buffer(device, {.size = chunks * kSumBytes, .name = "sums per chunk"});
    sums = vk::Buffer(device, {.size = kSumBytes, .name = "sums over chunks"});
    if (desc.local) {
        local = vk::Buffer(device, {.size = localBytes(chunks), .name = "local errors"});
        scales = vk::Buffer(device, {.size = chunks * sizeof(glm::vec2), .name = "scales of chunks"});
    }
    rays = vk::Buffer(device, {.size = shader::kRayCounters * sizeof(uint32_t), .name = "ray counters"});
}

SpilledBytes LinkBuffers::bytes(const SolverExtent& extent, const Desc& desc, uint64_t receivers) {
    const uint64_t count = extent.patches();
    const uint64_t coarse =
        receivers * (sizeof(shader::Patch) + sizeof(shader::CoarseNeighbours) + vec4s(kReplicates)) +
        (receivers > 0 ? count * sizeof(shader::CoarseTaps) : 0);
    const uint64_t coarseDistances = desc.smooth ? receivers * sizeof(glm::vec2) : 0;
    const uint64_t notes = desc.notes ? extent.chunkCount * sizeof(glm::uvec2) : 0;
    const uint64_t localError =
        desc.local ? localBytes(extent.chunkCount) + extent.chunkCount * sizeof(glm::vec2) : 0;
    SpilledBytes bytes;
    bytes.device = count * sizeof(uint32_t) + extent.texels * sizeof(uint32_t) + coarse + coarseDistances +
                   localError + notes + (uint64_t{extent.chunkCount} + 1) * kSumBytes +
                   shader::kRayCounters * sizeof(uint32_t);
    const auto add = [&](uint64_t each, Spill first) { bytes.add(count * each, first, desc.spill); };
    add(vec4s(1) + (desc.smooth ? vec4s(kReplicates) + sizeof(glm::vec2) : 0), Spill::Smoothing);
    add(vec4s(1) + (desc.direct ? vec4s(kReplicates) : 0), Spill::Direct);
    add(vec4s(kReplicates) + (desc.carries ? vec4s(1) : 0), Spill::Links);
    return bytes;
}

uint32_t smoothingReach(float sigma) {
    constexpr float kReachInSigmas = 2.0f;
    constexpr uint32_t kMostReach = 8; // kMaxReach of lib/smoothing.glsl
    constexpr float kNoneBelow = 0.3f; // [texels]: a neighbour then counts for less than half a percent
    if (sigma < kNoneBelow) return 0;
    return std::min(kMostReach, static_cast<uint32_t>(std::ceil(kReachInSigmas * sigma)));
}

float carriedShare(uint32_t samplePasses) {
    constexpr float kFading = 3.0f; // the power becomes 3 (1 - q); carried noise has 1.8 times the variance
    return std::min(1.0f, kFading / static_cast<float>(samplePasses));
}

shader::ResolveSums sumsOf(std::span<const shader::ResolveSums> chunks) {
    std::array<double, 6> total{};
    for (const shader::ResolveSums& s : chunks) {
        const std::array<float, 6> terms = {s.light, s.direct, s.indirect, s.raw, s.bias, s.count};
        for (size_t k = 0; k < total.size(); ++k)
            total[k] += terms[k];
    }
    const auto f = [&](size_t k) { return static_cast<float>(total[k]); };
    return {f(0), f(1), f(2), f(3), f(4), f(5)};
}

glm::dvec4 sumsOf(std::span<const glm::vec4> chunks) {
    glm::dvec4 total(0.0);
    for (const glm::vec4& sum : chunks)
        total += glm::dvec4(sum);
    return total;
}

void LinkGatherPass::gatherOnCpu(const LightBuffers& light, const LinkBuffers& buffers,
                                 const Work& work) const {
    const bool coarse = buffers.receiverCount > 0;
    glm::vec4* sums = coarse            ? buffers.coarseSums.as<glm::vec4>()
                      : work.accumulate ? buffers.linkSums.as<glm::vec4>()
                                        : nullptr;
    gatherLinks(*pool_, {.links = work.links->as<uint32_t>() + work.linksOffset,
                         .radiance = light.radiance.as<glm::vec4>(),
                         .sky = work.sky,
                         .direct = work.direct && !coarse ? work.direct->as<glm::vec4>() : nullptr,
                         .ligOut = coarse || !work.output ? nullptr : light.ligOut.as<glm::vec4>(),
                         .sums = sums,
                         .newSums = work.newSums,
                         .firstChunk = work.range.first,
                         .chunkCount = work.range.count,
                         .samples = work.samples,
                         .patchCount = coarse ? buffers.receiverCount : light.chunkCount * kChunk});
}

void LinkGatherPass::sendOnCpu(const LightBuffers& light, float reflectivity,
                               const std::vector<uint8_t>& full, glm::vec4* changes, bool isFirst) const {
    sendLight(*pool_, {.patches = light.patches.as<shader::Patch>(),
                       .albedo = light.albedo.as<glm::vec4>(),
                       .before = light.ligIn.as<glm::vec4>(),
                       .light = light.ligOut.as<glm::vec4>(),
                       .radiance = light.radiance.as<glm::vec4>(),
                       .changes = changes,
                       .isFirst = isFirst,
                       .full = full.data(),
                       .reflectivity = reflectivity,
                       .chunkCount = light.chunkCount});
}

void LinkGatherPass::startOnCpu(const LightBuffers& light, float reflectivity,
                                const std::vector<uint8_t>& full, const vk::Buffer& first) const {
    std::memcpy(light.ligIn.as<glm::vec4>(), first.as<glm::vec4>(), light.ligIn.size());
    sendLight(*pool_, {.patches = light.patches.as<shader::Patch>(),
                       .albedo = light.albedo.as<glm::vec4>(),
                       .light = light.ligIn.as<glm::vec4>(),
                       .radiance = light.radiance.as<glm::vec4>(),
                       .full = full.data(),
                       .reflectivity = reflectivity,
                       .chunkCount = light.chunkCount});
}

void LinkGatherPass::recordPack(VkCommandBuffer cmd, const LightBuffers& light,
                                const LinkBuffers& buffers) const {
    if (pool_) return;
    const auto count = static_cast<uint32_t>(buffers.packed.size() / sizeof(glm::uvec2));
    const shader::PackPush push{
        .radiance = light.radiance.address(), .packed = buffers.packed.address(), .count = count};
    dispatchChunks(pack_, cmd, push, (count + kChunk - 1) / kChunk);
}

void LinkGatherPass::record(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                            const Work& work) const {
    if (pool_) return gatherOnCpu(light, buffers, work);
    const bool coarse = buffers.receiverCount > 0;
    const VkDeviceAddress sums = coarse            ? buffers.coarseSums.address()
                                 : work.accumulate ? buffers.linkSums.address()
                                                   : 0;
    const shader::LinkPush push{.links = work.address(),
                                .packed = buffers.packed.address(),
                                .direct = work.direct && !coarse ? work.direct->address() : 0,
                                .ligOut = coarse || !work.output ? 0 : light.ligOut.address(),
                                .sums = sums,
                                .firstChunk = work.range.first,
                                .chunkCount = work.range.count,
                                .sampleCount = work.samples,
                                .patchCount = coarse ? buffers.receiverCount : light.chunkCount * kChunk,
                                .sky = work.sky};
    dispatchChunks(gather_, cmd, push, work.range.count);
}

void LinkGatherPass::recordDistances(VkCommandBuffer cmd, const LightBuffers& light,
                                     const LinkBuffers& buffers, const Work& work) const {
    const bool coarse = buffers.receiverCount > 0;
    const shader::LinkDistancePush push{
        .patches = light.patches.address(),
        .links = work.address(),
        .receivers = coarse ? buffers.receivers.address() : light.patches.address(),
        .nodes = work.nodes,
        .distances = coarse ? buffers.coarseDistances.address() : buffers.distances.address(),
        .patchChart = buffers.patchChart.address(),
        .texelToPatch = buffers.texelToPatch.address(),
        .firstChunk = work.range.first,
        .chunkCount = work.range.count,
        .sampleCount = work.samples,
        .patchCount = light.chunkCount * kChunk,
        .size = coarse ? 0 : buffers.size};
    dispatchChunks(distance_, cmd, push, work.range.count);
}

void LinkGatherPass::recordInterpolate(VkCommandBuffer cmd, const LightBuffers& light,
                                       const LinkBuffers& buffers, const Work& work) const {
    const shader::InterpolatePush push{.taps = buffers.taps.address(),
                                       .coarse = buffers.coarseSums.address(),
                                       .direct = work.direct ? work.direct->address() : 0,
                                       .ligOut = light.ligOut.address(),
                                       .sums = work.accumulate ? buffers.linkSums.address() : 0,
                                       .coarseDistances =
                                           work.distances ? buffers.coarseDistances.address() : 0,
                                       .distances = work.distances ? buffers.distances.address() : 0,
                                       .firstChunk = work.range.first,
                                       .chunkCount = work.range.count,
                                       .patchCount = light.chunkCount * kChunk,
                                       .receiverCount = buffers.receiverCount,
                                       .scale = 1.0f / static_cast<float>(work.samples)};
    dispatchChunks(interpolate_, cmd, push, work.range.count);
}

void LinkGatherPass::recordCompose(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                                   const vk::Buffer* direct, uint32_t samples, const vk::Buffer* scales,
                                   const SomeChunks& chunks) const {
    forRuns(chunks, light.chunkCount, [&](const ChunkRange& run) {
        const shader::ComposePush push{.sums = buffers.linkSums.address(),
                                       .direct = direct ? direct->address() : 0,
                                       .light = light.ligIn.address(),
                                       .scales = scales ? scales->address() : 0,
                                       .firstChunk = run.first,
                                       .chunkCount = run.count,
                                       .patchCount = light.chunkCount * kChunk,
                                       .scale = samples > 0 ? 1.0f / static_cast<float>(samples) : 0.0f};
        dispatchChunks(compose_, cmd, push, run.count);
    });
}

void LinkGatherPass::recordCarry(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                                 const vk::Buffer* direct, float share, const SomeChunks& chunks) const {
    forRuns(chunks, light.chunkCount, [&](const ChunkRange& run) {
        const uint64_t at = uint64_t{run.first} * kChunk * sizeof(glm::vec4);
        const shader::CarryPush push{.carried = buffers.carried.address() + at,
                                     .direct = direct ? direct->address() + at : 0,
                                     .light = (share > 0 ? light.ligOut : light.ligIn).address() + at,
                                     .share = share,
                                     .patchCount = run.count * kChunk};
        dispatchChunks(carry_, cmd, push, run.count);
    });
}

void LinkGatherPass::recordDirectMean(VkCommandBuffer cmd, const LightBuffers& light,
                                      const LinkBuffers& buffers, uint32_t samplePasses,
                                      const vk::Buffer* scales) const {
    const shader::ComposePush push{
        .sums = buffers.directSums.address(),
        .light = buffers.direct.address(),
        .scales = scales ? scales->address() : 0,
        .sampled = 1,
        .chunkCount = light.chunkCount,
        .patchCount = light.chunkCount * kChunk,
        .scale = samplePasses > 0 ? 1.0f / static_cast<float>(kReplicates * samplePasses) : 0.0f};
    dispatchChunks(compose_, cmd, push, light.chunkCount);
}

void ResolvePass::recordChange(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                               const SomeChunks& chunks, bool isFirst) const {
    forRuns(chunks, light.chunkCount, [&](const ChunkRange& run) {
        const uint64_t first = uint64_t{run.first} * kChunk;
        const shader::ChangePush push{.patches = light.patches.address() + first * sizeof(shader::Patch),
                                      .ligIn = light.ligIn.address() + first * sizeof(glm::vec4),
                                      .ligOut = light.ligOut.address() + first * sizeof(glm::vec4),
                                      .sums = buffers.chunkSums.address() + run.first * sizeof(glm::vec4),
                                      .chunkCount = run.count,
                                      .isFirst = isFirst ? 1u : 0u};
        dispatchChunks(change_, cmd, push, run.count);
    });
}

void ResolvePass::recordCoarse(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                               uint32_t samples) const {
    const uint32_t chunks = buffers.receiverCount / kChunk;
    const shader::CoarseErrorPush push{.neighbours = buffers.neighbours.address(),
                                       .sums = buffers.linkSums.address(),
                                       .chunkSums = buffers.chunkSums.address(),
                                       .chunkCount = chunks,
                                       .patchCount = light.chunkCount * kChunk,
                                       .scale =
                                           static_cast<float>(kReplicates) / static_cast<float>(samples)};
    dispatchChunks(coarse_, cmd, push, chunks);
}

void ResolvePass::record(VkCommandBuffer cmd, const LightBuffers& light, const LinkBuffers& buffers,
                         const Work& work) const {
    const uint32_t reach = buffers.rows ? smoothingReach(work.sigma) : 0;
    const float perReplicate = static_cast<float>(work.samples) / static_cast<float>(kReplicates);
    shader::SmoothPush push{
        .patches = light.patches.address(),
        .patchChart = buffers.patchChart.address(),
        .texelToPatch = buffers.texelToPatch.address(),
        .sums = (work.sums ? *work.sums : buffers.linkSums).address(),
        .rows = buffers.rows ? buffers.rows.address() : 0,
        .directSums = work.directSamplePasses > 0 && buffers.directSums ? buffers.directSums.address() : 0,
        .result = buffers.result.address(),
        .chunkSums = buffers.chunkSums.address(),
        .distances = buffers.distances ? buffers.distances.address() : 0,
        .scales = work.scaled ? buffers.scales.address() : 0,
        .local = work.local ? buffers.local.address() : 0,
        .firstChunk = 0,
        .chunkCount = 0,
        .patchCount = light.chunkCount * kChunk,
        .size = buffers.size,
        .reach = reach,
        .sigma = work.sigma,
        .scale = work.samples > 0 ? 1.0f / perReplicate : 0.0f,
        .directScale =
            work.directSamplePasses > 0 ? 1.0f / static_cast<float>(work.directSamplePasses) : 0.0f,
        .floor = work.floor};
    if (work.local) {
        vkCmdFillBuffer(cmd, buffers.local.handle(), 0, VK_WHOLE_SIZE, 0);
        vk::barrier(cmd);
    }
    const auto dispatch = [&](const vk::ComputeProgram& program, const SomeChunks& chunks) {
        forRuns(chunks, light.chunkCount, [&](const ChunkRange& run) {
            push.firstChunk = run.first;
            push.chunkCount = run.count;
            dispatchChunks(program, cmd, push, run.count);
        });
    };
    if (reach > 0) {
        dispatch(smooth_, work.rows);
        vk::barrier(cmd);
    }
    dispatch(resolve_, work.chunks);
}

} // namespace relume
