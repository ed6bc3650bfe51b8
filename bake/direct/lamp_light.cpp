#include "bake/direct/lamp_light.h"

#include "assets/base/error.h"
#include "bake/direct/host_lamps.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;

constexpr uint32_t kGroupRays = LampLight::kMostGroupRays;
// A batch of such groups has so many chunks, whose targets are 64 KiB each; of smaller groups it has more.
constexpr uint32_t kGpuLampChunks = 4096, kSoftwareLampChunks = 512;
constexpr uint32_t kMostChunks = 32768;             // that every device's dispatches take in x
constexpr uint64_t kLeastTable = sizeof(glm::vec4); // [bytes] of the two tables, which are never empty

// Returns the rays to a light without extent: a shadow's edge in a texel has to be sampled, too.
uint32_t pointRays(bool allOver) {
    return allOver ? kReplicates : 1;
}

uint32_t wordsOf(uint32_t targets) {
    return (targets + kTargetsPerWord - 1) / kTargetsPerWord;
}

uint32_t mostChunks(uint32_t chunkCount, bool software, uint32_t rays) {
    const uint32_t smaller = kGroupRays / std::clamp(rays, 1u, kGroupRays);
    return std::max(kMostTogether, std::min({chunkCount, kMostChunks,
                                             (software ? kSoftwareLampChunks : kGpuLampChunks) * smaller}));
}

// Makes a buffer of the sky's pixels with its rows behind them.
vk::Buffer makeSky(const vk::Device& device, const LampSet& set) {
    const std::span<const glm::vec4> pixels(set.skyPixels);
    const std::span<const float> rows(set.skyRows);
    vk::Buffer sky(device,
                   {.size = std::max(kLeastTable, pixels.size_bytes() + rows.size_bytes()), .name = "sky"});
    if (!pixels.empty()) vk::upload(device, sky, pixels.data(), pixels.size_bytes());
    if (!rows.empty()) vk::upload(device, sky, rows.data(), rows.size_bytes(), pixels.size_bytes());
    return sky;
}

} // namespace

LampLight::LampLight(const vk::Device& device, const Scene& scene, const PatchSet& patches, const Desc& desc)
    : device_(device), desc_(desc), chunkCount_(patches.chunkCount()),
      set_(buildLamps(scene, patches.scene.mesh, lampDesc())), sky_(makeSky(device, set_)) {
    if (!desc.chosen) group(std::vector<uint32_t>(set_.lamps.size(), 0));
}

LampDesc LampLight::lampDesc() const {
    return {.samples = desc_.samples,
            .pointSamples = pointRays(desc_.allOver),
            .sky = desc_.sky,
            .unit = desc_.chosen};
}

void LampLight::update(const Scene& scene, std::span<const LampChoice> choices) {
    ASSERT(desc_.chosen);
    const bool skyShines = scene.sky.shines() && (set_.skyRows.empty() || set_.skyRows.back() > 0.0f);
    set_.skyRotation = scene.sky.rotation;
    const std::vector<shader::Lamp> lamps = lampsOf(scene, skyShines, lampDesc());
    set_.lamps.clear();
    std::vector<uint32_t> sets;
    for (const LampChoice& choice : choices) {
        if (choice.lamp >= lamps.size()) continue; // a sky whose picture is black
        set_.lamps.push_back(lamps[choice.lamp]);
        set_.lamps.back().color = choice.color;
        sets.push_back(choice.set);
    }
    group(sets);
}

std::vector<uint32_t> LampLight::groupsOf(uint32_t set) const {
    std::vector<uint32_t> found;
    for (uint32_t i = 0; i < groups_.size(); ++i)
        if (groups_[i].set == set) found.push_back(i);
    return found;
}

bool LampLight::updateReach(const WorldMesh& mesh) {
    const float before = std::exchange(set_.reach, reachOf(mesh));
    return set_.reach != before;
}

void LampLight::group(const std::vector<uint32_t>& sets) {
    groups_.clear();
    rays_ = 0;
    if (set_.empty()) return;
    uint32_t most = 0;
    for (uint32_t i = 0; i < set_.lamps.size(); ++i) {
        shader::Lamp& lamp = set_.lamps[i];
        if (groups_.empty() || groups_.back().set != sets[i] ||
            groups_.back().targets + lamp.samples > kGroupRays ||
            (desc_.allOver && set_.lamps[i - 1].samples != lamp.samples)) // which the tracer counts by
            groups_.push_back({.first = i, .set = sets[i]});
        Group& group = groups_.back();
        lamp.firstTarget = group.targets;
        group.targets += lamp.samples;
        ++group.count;
        rays_ += lamp.samples;
        most = std::max(most, group.targets);
    }
    // A light that is dragged changes the buffer's content many times a second.
    const std::span<const shader::Lamp> lamps(set_.lamps);
    if (lamps_ && lamps_.size() >= lamps.size_bytes())
        vk::upload(device_, lamps_, lamps.data(), lamps.size_bytes());
    else
        lamps_ = vk::makeBuffer(device_, lamps, "lamps");
    if (room_ == 0) {
        programs_ = {vk::ComputeProgram::builtAtFirstUse(device_, "lamp_samples"),
                     vk::ComputeProgram::builtAtFirstUse(device_, "lamp_gather")};
        skyPrograms_ = {
            vk::ComputeProgram::builtAtFirstUse(device_, "lamp_samples", {1u << shader::kLampSky}),
            vk::ComputeProgram::builtAtFirstUse(device_, "lamp_gather", {1u << shader::kLampSky})};
    }
    if (most <= room_) return;
    room_ = most;
    batchChunks_ = mostChunks(chunkCount_, device_.info().software(), most);
    const uint64_t places = uint64_t{batchChunks_} * kChunk;
    targets_ = vk::Buffer(device_, {.size = places * most * sizeof(glm::vec4), .name = "points on lamps"});
    bits_ = vk::Buffer(device_, {.size = places * wordsOf(most) * sizeof(uint32_t), .name = "seen lamps"});
}

uint32_t LampLight::groupRays(const Count& lights, uint32_t samples, bool allOver) {
    const uint64_t all = uint64_t{lights.extended} * samples + uint64_t{lights.points} * pointRays(allOver);
    const uint64_t most = std::max(kGroupRays, lights.extended > 0 ? samples : 1u);
    return static_cast<uint32_t>(std::min(all, most));
}

uint64_t LampLight::tableBytes(const Count& lights, uint64_t skyPixels, uint64_t skyRows) {
    // So many lights are counted in any case: their number may not be known yet.
    constexpr uint64_t kLeastLights = 64;
    const uint64_t count = std::max(kLeastLights, uint64_t{lights.extended} + lights.points);
    return 2 * kLeastTable + count * sizeof(shader::Lamp) + skyPixels * sizeof(glm::vec4) +
           skyRows * sizeof(float);
}

uint64_t LampLight::bytes(uint32_t chunkCount, bool software, uint32_t rays) {
    const uint64_t places = uint64_t{mostChunks(chunkCount, software, rays)} * kChunk;
    return places * (rays * sizeof(glm::vec4) + wordsOf(rays) * sizeof(uint32_t));
}

shader::LampPush LampLight::push(const LightBuffers& light, const Work& work) const {
    const Group& group = groups_[work.group];
    const vk::Buffer* covers = light.coversIf(desc_.allOver);
    return {.patches = light.patches.address(),
            .lamps = lamps_.address(),
            .targets = targets_.address(),
            .bits = bits_.address(),
            .sky = sky_.address(),
            .parts = work.penumbra ? work.penumbra->parts.address() : 0,
            .penumbra = penumbraOf(work.penumbra, work.notes),
            .covers = covers ? covers->address() : 0,
            .chunks = work.chunks ? work.chunks->address() : 0,
            .skySize = set_.skySize.x | set_.skySize.y << 16,
            .skyRotation = set_.skyRotation,
            .reach = set_.reach,
            .firstChunk = work.range.first,
            .firstLamp = group.first,
            .counts = group.count | (group.targets * work.together) << 16,
            .samplePass = work.samplePass,
            .together = work.together,
            .patchCount = light.chunkCount * kChunk,
            .scale = 1.0f / static_cast<float>(kReplicates * work.together * (work.samplePass + 1))};
}

bool LampLight::onCpu(uint32_t group) const {
    const auto first = set_.lamps.begin() + groups_[group].first;
    return std::none_of(first, first + groups_[group].count,
                        [](const shader::Lamp& lamp) { return lamp.type == shader::kLampSky; });
}

// A software device builds the programs for all types for half a second, and the CPU has all lights but the
// sky: those for the sky alone are built in two thirds of that. The driver of a GPU builds one faster than
// two.
const LampLight::Programs& LampLight::programsOf(uint32_t group) const {
    const auto first = set_.lamps.begin() + groups_[group].first;
    const bool sky = std::all_of(first, first + groups_[group].count,
                                 [](const shader::Lamp& lamp) { return lamp.type == shader::kLampSky; });
    return sky && device_.info().software() ? skyPrograms_ : programs_;
}

PointTimes LampLight::traceOnCpu(const LightBuffers& light, const Work& work, const PointsOnCpu& on) const {
    const Group& group = groups_[work.group];
    const SegmentWork rays = segments(light, work, on.rays);
    const HostLamps lamps{.points = hostPoints(light, rays, work.together, work.penumbra, on),
                          .lamps = std::span(set_.lamps).subspan(group.first, group.count),
                          .reach = set_.reach};
    return tracePointsOnCpu(
        on, rays, [&] { sampleLamps(on.pool, lamps); }, [&] { gatherLamps(on.pool, lamps); });
}

void LampLight::recordSamples(VkCommandBuffer cmd, const LightBuffers& light, const Work& work) const {
    shader::LampPush p = push(light, work);
    p.direct = work.soFar ? work.soFar->address() : 0;
    programsOf(work.group).samples.dispatch(cmd, p, work.range.count, groups_[work.group].count);
}

SegmentWork LampLight::segments(const LightBuffers& light, const Work& work, const vk::Buffer& rays) const {
    const Group& group = groups_[work.group];
    return {.firstChunk = work.range.first,
            .chunkCount = work.range.count,
            .chunks = work.chunks,
            .targetCount = group.targets * work.together,
            .targets = &targets_,
            .bits = &bits_,
            .rays = &rays,
            .covers = light.coversIf(desc_.allOver),
            .samplePass = work.samplePass,
            .turn = set_.lamps[group.first].samples * work.together};
}

void LampLight::recordGather(VkCommandBuffer cmd, const LightBuffers& light, const Work& work,
                             const vk::Buffer& sums, const vk::Buffer& direct) const {
    shader::LampPush p = push(light, work);
    p.sums = sums.address();
    p.direct = direct.address();
    programsOf(work.group).gather.dispatch(cmd, p, work.range.count);
}

} // namespace relume
