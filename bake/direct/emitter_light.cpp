#include "bake/direct/emitter_light.h"

#include "bake/direct/host_emitters.h"
#include "bake/direct/host_wholes.h"
#include "bake/lights/emitter_edges.h"

#include <algorithm>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;

constexpr uint32_t kPointsPerPick = 4; // the fewest that a share can be told from, stratified 2 x 2
// Each of so few polygons that are all sampled gets as many points as there are links; each of more gets a
// part of that.
constexpr uint32_t kFewPolygons = 4, kPartOfLinks = 4;
// A batch has so many chunks, where patches have no more targets than these, which take 1 KiB per chunk each;
// a single light has few.
constexpr uint32_t kGpuEmitterChunks = 8192, kSoftwareEmitterChunks = 512;
constexpr uint32_t kUsualTargets = 64, kUsualTargetsOfLight = 16;
// More targets leave room for fewer chunks, but not for fewer than these: threads share them, and sample
// passes that are taken together divide them further.
constexpr uint32_t kFewestEmitterChunks = 128;

// There is room for one chunk at least of sample passes that are taken together.
uint32_t emitterChunks(uint32_t chunkCount, bool software, bool lightByLight, uint32_t targets) {
    const uint32_t usual = software ? kSoftwareEmitterChunks : kGpuEmitterChunks;
    const uint32_t usualTargets = lightByLight ? kUsualTargetsOfLight : kUsualTargets;
    const uint32_t chunks =
        std::max(kFewestEmitterChunks, usual * usualTargets / std::max(targets, usualTargets));
    return std::max(kMostTogether, std::min(chunkCount, chunks));
}

// Makes the buffer anew where it is smaller.
void reserve(const vk::Device& device, vk::Buffer& buffer, uint64_t size, const char* name) {
    if (!buffer || buffer.size() < size) buffer = vk::Buffer(device, {.size = size, .name = name});
}

uint32_t wordsOfPoints(uint32_t targets) {
    return (targets + kTargetsPerWord - 1) / kTargetsPerWord;
}

uint64_t wholeBytes(uint32_t chunkCount) {
    return uint64_t{chunkCount} * kChunk * sizeof(glm::vec4);
}

} // namespace

EmitterLight::EmitterLight(const vk::Device& device, const PatchSet& patches, const Desc& desc)
    : device_(device), desc_(desc), chunkCount_(patches.chunkCount()),
      batchChunks_(emitterChunks(patches.chunkCount(), device.info().software(), desc.lightByLight, 0)),
      samples_(vk::ComputeProgram::builtAtFirstUse(device, "emitter_samples")),
      gather_(vk::ComputeProgram::builtAtFirstUse(device, "direct")) {}

void EmitterLight::setGroups(const std::vector<EmitterSet>& groups) {
    groups_.clear();
    uint32_t picks = 0, targets = 0;
    bool whole = false;
    for (const EmitterSet& set : groups) {
        groups_.push_back(makeGroup(set));
        whole = whole || groups_.back().whole;
        picks = std::max(picks, groups_.back().picksRoom());
        targets = std::max(targets, groups_.back().targets());
    }
    wholes_.group.reset();
    if (whole && !wholes_.light)
        wholes_.light = vk::Buffer(device_, {.size = wholeBytes(chunkCount_), .name = "whole mesh lights"});
    batchChunks_ = emitterChunks(chunkCount_, device_.info().software(), desc_.lightByLight, targets);
    const uint64_t places = uint64_t{batchChunks_} * kChunk;
    if (picks > 0) reserve(device_, picks_, places * picks * sizeof(glm::vec4), "picked emitters");
    if (targets == 0) return;
    reserve(device_, targets_, places * targets * sizeof(glm::vec4), "points on emitters");
    reserve(device_, bits_, places * wordsOfPoints(targets) * sizeof(uint32_t), "seen points");
}

EmitterLight::Group EmitterLight::makeGroup(const EmitterSet& set) const {
    Group group;
    group.polygonCount = static_cast<uint32_t>(set.polygons.size());
    static_cast<Sampling&>(group) = samplingOf(group.polygonCount, desc_);
    group.polygons = vk::makeBuffer(device_, set.polygons, "emitters");
    group.nodes = vk::makeBuffer(device_, set.nodes, "light tree");
    if (!group.whole) return group;
    const std::vector<shader::EmitterEdge> edges = emitterEdges(set.polygons);
    group.edgeCount = static_cast<uint32_t>(edges.size());
    group.edges = vk::makeBuffer(device_, edges, "edges of emitters");
    return group;
}

EmitterLight::Sampling EmitterLight::samplingOf(uint32_t polygons, const Desc& desc) {
    if (polygons <= (desc.lightByLight ? kAllOfLight : kAllEmitters))
        return {.picks = polygons,
                .points =
                    polygons <= kFewPolygons ? desc.links : std::max(desc.links / kPartOfLinks, kReplicates),
                .all = true};
    if (desc.lightByLight && polygons <= kMostOfWhole)
        return {.picks = std::max(desc.links, kReplicates), .points = 1, .all = false, .whole = true};
    return {
        .picks = std::max(desc.links / kPointsPerPick, kReplicates), .points = kPointsPerPick, .all = false};
}

uint64_t EmitterLight::bytes(uint32_t chunkCount, bool software, const Desc& desc, uint32_t polygons) {
    const auto batch = [&](const Sampling& sampling, uint32_t picks) {
        const uint32_t targets = sampling.targets();
        const uint64_t places =
            uint64_t{emitterChunks(chunkCount, software, desc.lightByLight, targets)} * kChunk;
        return places * ((picks + targets) * sizeof(glm::vec4) + wordsOfPoints(targets) * sizeof(uint32_t));
    };
    const Sampling largest = samplingOf(polygons, desc);
    uint64_t batches = batch(largest, largest.picksRoom()), wholes = 0;
    // A binary tree has fewer than two nodes per polygon.
    const uint64_t tables = polygons * (sizeof(shader::EmitterPolygon) + 2 * sizeof(shader::EmitterNode)) +
                            sizeof(shader::EmitterNode);
    if (desc.lightByLight && polygons > kAllOfLight) {
        // The largest light may be one that picks, while others have their whole light found, or all of their
        // polygons sampled: what a batch has room for then depends on which others there are.
        const uint32_t ofWhole = samplingOf(kMostOfWhole, desc).picksRoom();
        for (uint32_t others = 1; others <= kAllOfLight; ++others) {
            const Sampling all = samplingOf(others, desc);
            batches = std::max(batches, batch(all, std::max(all.picksRoom(), ofWhole)));
        }
        // A polygon has four edges at most.
        wholes = wholeBytes(chunkCount) +
                 uint64_t{std::min(polygons, kMostOfWhole)} * 4 * sizeof(shader::EmitterEdge);
    }
    return tables + wholes + batches;
}

// Tells whether any of the chunks is not known yet; they are from then on.
bool EmitterLight::learnWholes(const Work& work) {
    if (!groups_[work.group].whole) return false;
    ASSERT(!work.chunks);
    if (wholes_.group != work.group) {
        wholes_.group = work.group;
        wholes_.knownChunks.assign(chunkCount_, 0);
    }
    const auto first = wholes_.knownChunks.begin() + work.range.first;
    const bool all = std::find(first, first + work.range.count, 0) == first + work.range.count;
    std::fill_n(first, work.range.count, uint8_t{1});
    return !all;
}

void EmitterLight::findWholesOnCpu(const LightBuffers& light, const Work& work) const {
    const Group& group = groups_[work.group];
    const vk::Buffer* covers = light.coversIf(desc_.allOver);
    const size_t patches = size_t{chunkCount_} * kChunk;
    findWholes(device_.workers(),
               {.polygons = {group.polygons.as<shader::EmitterPolygon>(), group.polygonCount},
                .edges = {group.edges.as<shader::EmitterEdge>(), group.edgeCount},
                .root = *group.nodes.as<shader::EmitterNode>(),
                .patches = {light.patches.as<shader::Patch>(), patches},
                .covers = covers ? covers->as<shader::PatchCover>() : nullptr,
                .wholes = {wholes_.light.as<glm::vec4>(), patches},
                .range = work.range});
}

void EmitterLight::recordSamples(VkCommandBuffer cmd, const LightBuffers& light, const Work& work) {
    const Group& group = groups_[work.group];
    const vk::Buffer* covers = light.coversIf(desc_.allOver);
    bool learns = learnWholes(work);
    if (learns && device_.info().software()) {
        findWholesOnCpu(light, work);
        learns = false;
    }
    const shader::EmitterSamplesPush push{.patches = light.patches.address(),
                                          .polygons = group.polygons.address(),
                                          .nodes = group.nodes.address(),
                                          .targets = targets_.address(),
                                          .picks = picks_.address(),
                                          .parts = work.penumbra ? work.penumbra->parts.address() : 0,
                                          .penumbra = work.penumbra ? work.penumbra->lights.address() : 0,
                                          .covers = covers ? covers->address() : 0,
                                          .edges = group.whole ? group.edges.address() : 0,
                                          .wholes = wholesOf(group),
                                          .chunks = work.chunks ? work.chunks->address() : 0,
                                          .firstChunk = work.range.first,
                                          .samplePass = work.samplePass,
                                          .together = work.together,
                                          .pickCount = group.picksOf(work.together),
                                          .pointCount = group.pointsOf(work.together),
                                          .all = group.all ? 1u : 0u,
                                          .polygonCount = group.polygonCount,
                                          .edgeCount = group.edgeCount,
                                          .firstNear = batchChunks_ / work.together};
    samples_.dispatch(cmd, push, work.range.count, push.pickCount + (learns ? 1 : 0));
}

PointTimes EmitterLight::traceOnCpu(const LightBuffers& light, const Work& work,
                                    const PointsOnCpu& on) const {
    const Group& group = groups_[work.group];
    const SegmentWork rays = segments(light, work, on.rays);
    const HostEmitters emitters{.points = hostPoints(light, rays, work.together, work.penumbra, on),
                                .polygons = {group.polygons.as<shader::EmitterPolygon>(), group.picks},
                                .picks = picks_.as<glm::vec4>(),
                                .near = picks_.as<glm::vec4>() +
                                        size_t{batchChunks_ / work.together} * group.picks * kChunk,
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
            .chunks = work.chunks,
            .targetCount = group.targets() * work.together,
            .targets = &targets_,
            .bits = &bits_,
            .rays = &rays,
            .covers = light.coversIf(desc_.allOver),
            .samplePass = work.samplePass,
            .turn = (group.all ? group.points : group.targets()) * work.together,
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
        .wholes = wholesOf(group),
        .chunks = work.chunks ? work.chunks->address() : 0,
        .firstChunk = work.range.first,
        .samplePass = work.samplePass,
        .together = work.together,
        .pickCount = group.picksOf(work.together),
        .pointCount = group.pointsOf(work.together),
        .all = group.all ? 1u : 0u,
        .firstNear = batchChunks_ / work.together,
        .patchCount = light.chunkCount * kChunk,
        .scale = 1.0f / static_cast<float>(kReplicates * work.together * (work.samplePass + 1))};
    gather_.dispatch(cmd, push, work.range.count);
}

} // namespace relume
