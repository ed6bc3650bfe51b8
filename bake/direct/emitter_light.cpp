#include "bake/direct/emitter_light.h"

#include "bake/direct/host_emitters.h"

#include <algorithm>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;

constexpr uint32_t kPointsPerPick = 4; // the fewest that a share can be told from, stratified 2 x 2
// A batch has so many chunks: their targets are 16 KiB each for 16 points.
constexpr uint32_t kGpuEmitterChunks = 8192, kSoftwareEmitterChunks = 512;

uint32_t mostChunks(uint32_t chunkCount, bool software) {
    return std::min(chunkCount, software ? kSoftwareEmitterChunks : kGpuEmitterChunks);
}

uint32_t wordsOfPoints(uint32_t targets) {
    return (targets + kTargetsPerWord - 1) / kTargetsPerWord;
}

} // namespace

EmitterLight::EmitterLight(const vk::Device& device, const PatchSet& patches, uint32_t links, bool allOver)
    : device_(device), links_(links), allOver_(allOver),
      batchChunks_(mostChunks(patches.chunkCount(), device.info().software())),
      samples_(vk::ComputeProgram::builtAtFirstUse(device, "emitter_samples")),
      gather_(vk::ComputeProgram::builtAtFirstUse(device, "direct")) {}

void EmitterLight::setGroups(const std::vector<EmitterSet>& groups) {
    groups_.clear();
    uint32_t picks = 0, targets = 0;
    for (const EmitterSet& set : groups) {
        groups_.push_back({samplingOf(static_cast<uint32_t>(set.polygons.size()), links_),
                           vk::makeBuffer(device_, set.polygons, "emitters"),
                           vk::makeBuffer(device_, set.nodes, "light tree")});
        picks = std::max(picks, groups_.back().picks);
        targets = std::max(targets, groups_.back().targets());
    }
    const uint64_t places = uint64_t{batchChunks_} * kChunk;
    if (picks > picksRoom_) {
        picksRoom_ = picks;
        picks_ = vk::Buffer(device_, {.size = places * picks * sizeof(glm::vec4), .name = "picked emitters"});
    }
    if (targets <= targetsRoom_) return;
    targetsRoom_ = targets;
    const uint64_t words = wordsOfPoints(targets);
    targets_ =
        vk::Buffer(device_, {.size = places * targets * sizeof(glm::vec4), .name = "points on emitters"});
    bits_ = vk::Buffer(device_, {.size = places * words * sizeof(uint32_t), .name = "seen points"});
}

EmitterLight::Sampling EmitterLight::samplingOf(uint32_t polygons, uint32_t links) {
    if (polygons <= kAllEmitters) return {.picks = polygons, .points = links, .all = true};
    return {.picks = std::max(links / kPointsPerPick, kReplicates), .points = kPointsPerPick, .all = false};
}

uint64_t EmitterLight::bytes(uint32_t chunkCount, bool software, uint32_t links, uint32_t polygons) {
    const Sampling sampling = samplingOf(polygons, links);
    const uint64_t places = uint64_t{mostChunks(chunkCount, software)} * kChunk;
    // A binary tree has fewer than two nodes per polygon.
    const uint64_t tables = polygons * (sizeof(shader::EmitterPolygon) + 2 * sizeof(shader::EmitterNode)) +
                            sizeof(shader::EmitterNode);
    return tables + places * ((sampling.picks + sampling.targets()) * sizeof(glm::vec4) +
                              wordsOfPoints(sampling.targets()) * sizeof(uint32_t));
}

void EmitterLight::recordSamples(VkCommandBuffer cmd, const LightBuffers& light, const Work& work) const {
    const Group& group = groups_[work.group];
    const vk::Buffer* covers = light.coversIf(allOver_);
    const shader::EmitterSamplesPush push{.patches = light.patches.address(),
                                          .polygons = group.polygons.address(),
                                          .nodes = group.nodes.address(),
                                          .targets = targets_.address(),
                                          .picks = picks_.address(),
                                          .parts = work.penumbra ? work.penumbra->parts.address() : 0,
                                          .penumbra = work.penumbra ? work.penumbra->lights.address() : 0,
                                          .covers = covers ? covers->address() : 0,
                                          .firstChunk = work.range.first,
                                          .samplePass = work.samplePass,
                                          .together = work.together,
                                          .pickCount = group.picks,
                                          .pointCount = group.points * work.together,
                                          .all = group.all ? 1u : 0u};
    samples_.dispatch(cmd, push, work.range.count, group.picks);
}

PointTimes EmitterLight::traceOnCpu(const LightBuffers& light, const Work& work,
                                    const PointsOnCpu& on) const {
    const Group& group = groups_[work.group];
    const SegmentWork rays = segments(light, work, on.rays);
    const HostEmitters emitters{.points = hostPoints(light, rays, work.together, work.penumbra, on),
                                .polygons = {group.polygons.as<shader::EmitterPolygon>(), group.picks},
                                .picks = picks_.as<glm::vec4>(),
                                .pointCount = group.points};
    return tracePointsOnCpu(
        on, rays, [&] { sampleEmitters(on.pool, emitters); }, [&] { gatherEmitters(on.pool, emitters); });
}

SegmentWork EmitterLight::segments(const LightBuffers& light, const Work& work,
                                   const vk::Buffer& rays) const {
    const Group& group = groups_[work.group];
    // The points of a pick belong to one replicate, those of a light that is always sampled to all in turn.
    return {.firstChunk = work.range.first,
            .chunkCount = work.range.count,
            .targetCount = group.targets() * work.together,
            .targets = &targets_,
            .bits = &bits_,
            .rays = &rays,
            .covers = light.coversIf(allOver_),
            .samplePass = work.samplePass,
            .turn = group.all ? group.points * work.together : group.targets(),
            .run = group.all ? 1 : group.points};
}

void EmitterLight::recordGather(VkCommandBuffer cmd, const LightBuffers& light, const Work& work,
                                const vk::Buffer& sums, const vk::Buffer& direct) const {
    const Group& group = groups_[work.group];
    const shader::DirectPush push{
        .targets = targets_.address(),
        .picks = picks_.address(),
        .bits = bits_.address(),
        .sums = sums.address(),
        .direct = direct.address(),
        .parts = work.penumbra ? work.penumbra->parts.address() : 0,
        .penumbra = work.penumbra ? work.penumbra->lights.address() : 0,
        .firstChunk = work.range.first,
        .samplePass = work.samplePass,
        .together = work.together,
        .pickCount = group.picks,
        .pointCount = group.points * work.together,
        .all = group.all ? 1u : 0u,
        .patchCount = light.chunkCount * kChunk,
        .scale = 1.0f / static_cast<float>(kReplicates * work.together * (work.samplePass + 1))};
    gather_.dispatch(cmd, push, work.range.count);
}

} // namespace relume
