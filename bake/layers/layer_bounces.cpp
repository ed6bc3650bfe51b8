#include "bake/layers/layer_bounces.h"

#include "bake/base/chunk_dispatch.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <array>
#include <bit>

namespace relume {
namespace {

using shader::kChunk;
using shader::kReplicates;

// Layers beside the first one may take this share of the memory that is free.
constexpr double kShare = 0.25;
constexpr std::array kPrograms = {"bounce", "bounce_two", "bounce_four", "bounce_eight"};
constexpr uint32_t kPasses = 2; // bounces of which changes are told
constexpr uint32_t kChangeValues = sizeof(glm::vec4) / sizeof(float);

} // namespace

LayerBounces::LayerBounces(const vk::Device& device, const LightBuffers& light, const vk::Buffer& sums)
    : device_(device), light_(light), sums_(sums),
      lanes_(device, {.size = kMostLanes * sizeof(shader::BounceLane),
                      .memory = vk::Memory::Host,
                      .name = "layers that bounce"}),
      totals_(device, {.size = kPasses * kMostLanes * sizeof(glm::vec4), .name = "changes by bounces"}),
      sum_(device) {
    const uint32_t invocations =
        std::min(device.limits().maxComputeWorkGroupInvocations, device.limits().maxComputeWorkGroupSize[0]);
    for (size_t i = 0; i < kPrograms.size() && (kChunk << i) <= invocations; ++i) {
        programs_.emplace_back(device, kPrograms[i], vk::Constants{0u});
        skyPrograms_.push_back(vk::ComputeProgram::builtAtFirstUse(device, kPrograms[i], {1u}));
    }
    makeSent(1);
}

void LayerBounces::makeSent(uint32_t lanes) {
    const uint64_t places = uint64_t{lanes} * light_.chunkCount * kChunk;
    for (vk::Buffer& sent : sent_)
        sent = vk::Buffer(device_, {.size = places * sizeof(glm::uvec2), .name = kPacked});
    changes_ = vk::Buffer(
        device_, {.size = kPasses * lanes * light_.chunkCount * sizeof(glm::vec4), .name = kChanges});
}

bool LayerBounces::grow(uint32_t lanes) {
    const VkDeviceSize light = light_.ligIn.size(), sums = sums_.size();
    const VkDeviceSize sent = sent_.size() * lanes * light_.chunkCount * kChunk * sizeof(glm::uvec2);
    const VkDeviceSize bytes = (lanes - room_) * (2 * light + sums) + sent;
    if (static_cast<double>(bytes) > kShare * static_cast<double>(device_.freeMemory())) return false;
    makeSent(lanes);
    for (; room_ < lanes; ++room_)
        beside_.push_back({vk::Buffer(device_, {.size = light, .name = kBesideLight}),
                           vk::Buffer(device_, {.size = light, .name = kBesideLight}),
                           vk::Buffer(device_, {.size = sums, .name = kBesideSums})});
    return true;
}

uint32_t LayerBounces::room(uint32_t layers) {
    const uint32_t most = 1u << (programs_.size() - 1);
    const uint32_t wanted = std::min(std::bit_ceil(layers), most);
    while (room_ < wanted && grow(2 * room_)) {
    }
    return std::min(layers, room_);
}

void LayerBounces::begin(std::span<const LayerGather::LaneLight> light) {
    count_ = static_cast<uint32_t>(light.size());
    lanesOf_ = std::bit_ceil(count_);
    live_ = (1u << count_) - 1u;
    from_ = now_ = 0;
    seesSky_ = std::any_of(light.begin(), light.end(),
                           [](const LayerGather::LaneLight& lane) { return lane.sky != glm::vec3(0.0f); });
    auto* lanes = lanes_.as<shader::BounceLane>();
    for (uint32_t i = 0; i < kMostLanes; ++i) {
        const uint32_t lane = i < count_ ? i : 0; // those that nobody needs only read
        const bool first = lane == 0;
        lanes[i] = {.direct = light[lane].direct->address(),
                    .lightA = first ? light_.ligIn.address() : beside_[lane - 1].lightA.address(),
                    .lightB = first ? light_.ligOut.address() : beside_[lane - 1].lightB.address(),
                    .sums = first ? sums_.address() : beside_[lane - 1].sums.address(),
                    .sky = light[lane].sky};
    }
}

void LayerBounces::recordStart(VkCommandBuffer cmd, std::span<const vk::Buffer* const> light) const {
    for (uint32_t lane = 0; lane < count_; ++lane) {
        const VkBufferCopy all{0, 0, light_.ligIn.size()};
        const vk::Buffer& to = lane == 0 ? light_.ligIn : beside_[lane - 1].lightA;
        vkCmdCopyBuffer(cmd, light[lane]->handle(), to.handle(), 1, &all);
    }
}

shader::BouncePush LayerBounces::push(float reflectivity) const {
    return {.lanes = lanes_.address(),
            .packed = sent_[now_].address(),
            .patches = light_.patches.address(),
            .albedo = light_.albedo.address(),
            .chunkCount = light_.chunkCount,
            .allChunks = light_.chunkCount,
            .patchCount = light_.chunkCount * kChunk,
            .live = live_,
            .from = from_,
            .reflectivity = reflectivity};
}

void LayerBounces::dispatch(VkCommandBuffer cmd, const shader::BouncePush& push, uint32_t chunks) const {
    const std::vector<vk::ComputeProgram>& programs = seesSky_ ? skyPrograms_ : programs_;
    dispatchChunks(programs[std::countr_zero(lanesOf_)], cmd, push, chunks);
}

void LayerBounces::recordSend(VkCommandBuffer cmd, float reflectivity) const {
    shader::BouncePush send = push(reflectivity);
    send.sent = sent_[now_].address();
    dispatch(cmd, send, light_.chunkCount);
}

void LayerBounces::record(VkCommandBuffer cmd, const Work& work) const {
    shader::BouncePush p = push(work.reflectivity);
    std::copy(work.links.begin(), work.links.end(), p.links);
    p.samplePasses = static_cast<uint32_t>(work.links.size());
    p.firstChunk = work.range.first;
    p.chunkCount = work.range.count;
    p.sampleCount = work.samples;
    p.sums = work.sums;
    p.scale = work.scale;
    if (!work.keeps) p.live = 0;
    if (work.ends) p.sent = sent_[1 - now_].address();
    if (work.ends && work.changes)
        p.changes =
            changes_.address() + uint64_t{*work.changes} * lanesOf_ * light_.chunkCount * sizeof(glm::vec4);
    dispatch(cmd, p, work.range.count);
}

void LayerBounces::endPass() {
    from_ ^= live_;
    now_ = 1 - now_;
}

void LayerBounces::recordChanges(VkCommandBuffer cmd) const {
    sum_.record(cmd, {.values = changes_.address(),
                      .sums = totals_.address(),
                      .chunkCount = light_.chunkCount,
                      .width = kChangeValues,
                      .groups = kPasses * lanesOf_});
}

} // namespace relume
