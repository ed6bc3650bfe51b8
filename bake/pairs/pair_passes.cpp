#include "bake/pairs/pair_passes.h"

#include "bake/base/chunk_dispatch.h"
#include "bake/pairs/host_pairs.h"
#include "bake/vk/commands.h"

#include <algorithm>

namespace relume {
namespace {

constexpr VkDeviceSize kPartialBytes = VkDeviceSize{2} * shader::kSuperPatches * sizeof(glm::vec4);

// Returns how many super-blocks' bits fit at once: 64 MiB and their transposes on a GPU, enough to fill it
// for 20 ms; a few on a software device, where a batch is small and the cache counts.
uint64_t superCapacity(bool software) {
    return software ? 16 : 512;
}

} // namespace

PairBuffers::PairBuffers(const vk::Device& device, uint64_t superCount, SenderKind kind) {
    // There is one more than there are super-blocks: a batch may end within one and begin within another.
    const uint64_t slots = std::min(superCapacity(device.info().software()), superCount + 1);
    capacity = static_cast<uint32_t>(slots);
    supers = vk::Buffer(device, {.size = slots * sizeof(SuperBlock), .name = "super-blocks"});
    if (kind == SenderKind::Patches)
        transposed =
            vk::Buffer(device, {.size = slots * superBytes(false), .name = "visibility bits, transposed"});
    partial = vk::Buffer(device, {.size = slots * kPartialBytes, .name = "partial sums"});
}

uint64_t PairBuffers::bytes(uint64_t superCount, SenderKind kind, bool bothEnds, bool software) {
    const uint64_t transposed = kind == SenderKind::Patches ? superBytes(false) : 0;
    return std::min(superCapacity(software), superCount + 1) *
           (sizeof(SuperBlock) + transposed + superBytes(bothEnds) + kPartialBytes);
}

BitsRing::BitsRing(const vk::Device& device, uint32_t slots, uint64_t bytes)
    : bits(device, {.size = slots * bytes, .name = "visibility bits"}), slotBytes(bytes) {}

uint32_t* BitsRing::host(uint64_t slot) const {
    return bits.mapped() ? static_cast<uint32_t*>(bits.mapped()) + slot * slotBytes / sizeof(uint32_t)
                         : nullptr;
}

GatherPass::GatherPass(const vk::Device& device, SenderKind kind, const TransportSettings& settings)
    : kind_(kind),
      pool_(device.info().software() && !settings.deviceGather && !settings.rtrad ? &device.workers()
                                                                                  : nullptr),
      reduce_(device, "reduce") {
    if (pool_) return;
    transpose_ = vk::ComputeProgram(device, "transpose");
    gather_ = vk::ComputeProgram(device, device.info().software() ? "gather_software" : "gather",
                                 {settings.rtrad ? 1u : 0u, static_cast<uint32_t>(kind)});
}

shader::GatherPush GatherPass::push(const Desc& desc) const {
    const LightBuffers& light = desc.light;
    const SenderBuffers* list = desc.senders;
    const bool own = kind_ != SenderKind::List; // senders are patches
    return {.supers = desc.pairs.supers.address(),
            .sends = (list ? list->sends : light.chunkSends).address(),
            .transposed = list ? 0 : desc.pairs.transposed.address(),
            .patches = light.patches.address(),
            .bounds = light.bounds.address(),
            .senderPatches = (own ? light.patches : list->patches).address(),
            .senderEdges = (own ? light.edges : list->edges).address(),
            .senderBounds = (list ? list->bounds : light.bounds).address(),
            .radiance = (own ? light.radiance : list->radiance).address(),
            .senders = list ? list->senders.address() : 0,
            .members = list ? list->members.address() : 0,
            .albedo = light.albedo.address(),
            .partial = desc.pairs.partial.address(),
            .rowCount = light.chunkCount,
            .columnCount = list ? list->chunkCount : light.chunkCount,
            .reflectivity = desc.transport.reflectivity,
            .distanceFactor = desc.transport.distanceFactor,
            .window = desc.window,
            .size = desc.size};
}

void GatherPass::gatherOnCpu(const Desc& desc) const {
    const LightBuffers& light = desc.light;
    const SenderBuffers* list = desc.senders;
    const bool own = kind_ != SenderKind::List, drawn = kind_ == SenderKind::Drawn;
    gatherPairs(*pool_, {.supers = desc.supers,
                         .bits = desc.bits,
                         .patches = light.patches.as<shader::Patch>(),
                         .bounds = light.bounds.as<shader::ChunkBounds>(),
                         .sends = (list ? list->sends : light.chunkSends).as<uint32_t>(),
                         .senderPatches = (own ? light.patches : list->patches).as<shader::Patch>(),
                         .senderEdges = (own ? light.edges : list->edges).as<shader::PatchEdges>(),
                         .senderBounds = (list ? list->bounds : light.bounds).as<shader::ChunkBounds>(),
                         .radiance = (own ? light.radiance : list->radiance).as<glm::vec4>(),
                         .senders = drawn ? list->senders.as<shader::Sender>() : nullptr,
                         .members = drawn ? list->members.as<uint32_t>() : nullptr,
                         .symmetric = kind_ == SenderKind::Patches,
                         .rowCount = light.chunkCount,
                         .columnCount = list ? list->chunkCount : light.chunkCount,
                         .partial = desc.pairs.partial.as<glm::vec4>()});
}

void GatherPass::record(VkCommandBuffer cmd, const Desc& desc) const {
    const bool symmetric = kind_ == SenderKind::Patches;
    const auto superCount = static_cast<uint32_t>(desc.supers.size());
    if (pool_) {
        gatherOnCpu(desc);
    } else if (symmetric) {
        const shader::TransposePush transpose{.supers = desc.pairs.supers.address(),
                                              .transposed = desc.pairs.transposed.address(),
                                              .chunkCount = desc.light.chunkCount,
                                              .reversed = desc.transport.rtrad ? 1u : 0u};
        transpose_.dispatch(cmd, transpose, shader::kSuperBlocks, superCount);
        vk::barrier(cmd);
    }
    if (!pool_) {
        gather_.dispatch(cmd, push(desc), (symmetric ? 2 : 1) * shader::kSuper, superCount);
        vk::barrier(cmd);
    }
    const shader::ReducePush reduce{.supers = desc.pairs.supers.address(),
                                    .partial = desc.pairs.partial.address(),
                                    .ligOut = desc.light.ligOut.address(),
                                    .superCount = superCount,
                                    .patchCount = desc.light.chunkCount * shader::kChunk,
                                    .symmetric = symmetric ? 1u : 0u};
    dispatchChunks(reduce_, cmd, reduce, desc.light.chunkCount);
}

void FinishPass::record(VkCommandBuffer cmd, const LightBuffers& light, bool rtrad) const {
    const shader::FinishPush push{.emission = light.emission.address(),
                                  .ligIn = light.ligIn.address(),
                                  .ligOut = light.ligOut.address(),
                                  .patchCount = light.chunkCount * shader::kChunk,
                                  .rtrad = rtrad ? 1u : 0u};
    dispatchChunks(program_, cmd, push, light.chunkCount);
}

} // namespace relume
