#include "bake/passes.h"

#include "bake/vk/commands.h"

#include <algorithm>

namespace relume {
namespace {

constexpr VkDeviceSize kBitsBytes =
    VkDeviceSize{shader::kSuperBlocks} * shader::kBlockWords * sizeof(uint32_t);
constexpr VkDeviceSize kPartialBytes = VkDeviceSize{2} * shader::kSuperPatches * sizeof(glm::vec4);

// Super-blocks whose bits fit at once: 64 MiB and their transposes on a GPU, enough to fill it for 20 ms; a
// few on a software device, where a batch is small and the cache counts.
uint64_t superCapacity(bool software) {
    return software ? 16 : 512;
}

// One workgroup per chunk, counted on in y: 65535 in x are all that a device must take.
template<typename Push>
void dispatchChunks(const vk::ComputeProgram& program, VkCommandBuffer cmd, const Push& push,
                    uint32_t chunks) {
    constexpr uint32_t kMaxX = 32768;
    const uint32_t x = std::min(chunks, kMaxX);
    program.dispatch(cmd, push, x, (chunks + x - 1) / x);
}

} // namespace

PairBuffers::PairBuffers(const vk::Device& device, uint64_t superCount, bool rtrad) {
    // One more than there are: a batch may end within a super-block and begin within another.
    const uint64_t slots = std::min(superCapacity(device.info().software()), superCount + 1);
    bitsUnits = static_cast<uint32_t>(slots) * shader::kSuperBlocks;
    supers = vk::Buffer(device, {.size = superCount * sizeof(SuperBlock), .name = "super-blocks"});
    bits = vk::Buffer(device, {.size = slots * kBitsBytes, .name = "visibility bits"});
    if (rtrad)
        reversed = vk::Buffer(device, {.size = slots * kBitsBytes, .name = "visibility bits, reversed"});
    transposed = vk::Buffer(device, {.size = slots * kBitsBytes, .name = "visibility bits, transposed"});
    partial = vk::Buffer(device, {.size = slots * kPartialBytes, .name = "partial sums"});
}

uint64_t PairBuffers::bytes(uint64_t superCount, bool software) {
    return superCount * sizeof(SuperBlock) + superCapacity(software) * (3 * kBitsBytes + kPartialBytes);
}

void RadiancePass::record(VkCommandBuffer cmd, const LightBuffers& light,
                          const TransportSettings& settings) const {
    const shader::RadiancePush push{.patches = light.patches.address(),
                                    .albedo = light.albedo.address(),
                                    .emission = light.emission.address(),
                                    .ligIn = light.ligIn.address(),
                                    .radiance = light.radiance.address(),
                                    .chunkSends = light.chunkSends.address(),
                                    .chunkCount = light.chunkCount,
                                    .reflectivity = settings.reflectivity,
                                    .rtrad = settings.rtrad ? 1u : 0u,
                                    .all = settings.allSend ? 1u : 0u,
                                    .reflected = settings.reflectedOnly ? 1u : 0u};
    dispatchChunks(program_, cmd, push, light.chunkCount);
}

// Staging senders in shared memory pays on GPUs (1.5x) and costs 3x on a software device.
GatherPass::GatherPass(const vk::Device& device, bool rtrad)
    : transpose_(device, "transpose"),
      gather_(device, "gather", {device.info().software() ? 0u : 1u, rtrad ? 1u : 0u}),
      reduce_(device, "reduce") {}

void GatherPass::record(VkCommandBuffer cmd, const LightBuffers& light, const PairBuffers& pairs,
                        const SuperRange& range, const TransportSettings& settings) const {
    const shader::TransposePush transpose{.supers = pairs.supers.address(),
                                          .bits = pairs.bits.address(),
                                          .reversed =
                                              (pairs.reversed ? pairs.reversed : pairs.bits).address(),
                                          .transposed = pairs.transposed.address(),
                                          .firstSuper = range.first,
                                          .bitsUnits = pairs.bitsUnits,
                                          .chunkCount = light.chunkCount};
    transpose_.dispatch(cmd, transpose, shader::kSuperBlocks, range.count);
    vk::barrier(cmd);
    const shader::GatherPush gather{.supers = pairs.supers.address(),
                                    .chunkSends = light.chunkSends.address(),
                                    .bits = pairs.bits.address(),
                                    .transposed = pairs.transposed.address(),
                                    .patches = light.patches.address(),
                                    .edges = light.edges.address(),
                                    .bounds = light.bounds.address(),
                                    .radiance = light.radiance.address(),
                                    .albedo = light.albedo.address(),
                                    .partial = pairs.partial.address(),
                                    .firstSuper = range.first,
                                    .bitsUnits = pairs.bitsUnits,
                                    .chunkCount = light.chunkCount,
                                    .reflectivity = settings.reflectivity,
                                    .distanceFactor = settings.distanceFactor};
    gather_.dispatch(cmd, gather, 2 * shader::kSuper, range.count);
    vk::barrier(cmd);
    const shader::ReducePush reduce{.supers = pairs.supers.address(),
                                    .partial = pairs.partial.address(),
                                    .ligOut = light.ligOut.address(),
                                    .firstSuper = range.first,
                                    .superCount = range.count,
                                    .patchCount = light.chunkCount * shader::kChunk};
    dispatchChunks(reduce_, cmd, reduce, light.chunkCount);
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
