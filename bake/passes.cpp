#include "bake/passes.h"

#include "bake/vk/commands.h"

namespace relume {
namespace {

constexpr uint32_t kGroup = 64; // invocations, as in the shaders

} // namespace

void RadiancePass::record(VkCommandBuffer cmd, const LightBuffers& light, uint32_t chunkCount,
                          const TransportSettings& settings) const {
    const shader::RadiancePush push{.patches = light.patches.address(),
                                    .albedo = light.albedo.address(),
                                    .emission = light.emission.address(),
                                    .ligIn = light.ligIn.address(),
                                    .radiance = light.radiance.address(),
                                    .chunkSends = light.chunkSends.address(),
                                    .chunkCount = chunkCount,
                                    .reflectivity = settings.reflectivity,
                                    .rtrad = settings.rtrad ? 1u : 0u,
                                    .all = settings.allSend ? 1u : 0u};
    program_.dispatch(cmd, push, (chunkCount + kGroup - 1) / kGroup);
}

// Staging senders in shared memory pays on GPUs (1.5x) and costs 3x on a software device.
GatherPass::GatherPass(const vk::Device& device, bool rtrad)
    : transpose_(device, "transpose"),
      gather_(device, "gather", {device.info().software() ? 0u : 1u, rtrad ? 1u : 0u}),
      reduce_(device, "reduce") {}

void GatherPass::record(VkCommandBuffer cmd, const LightBuffers& light, const PairBuffers& pairs,
                        uint32_t first, uint32_t count, uint32_t chunkCount,
                        const TransportSettings& settings) const {
    const shader::TransposePush transpose{.supers = pairs.supers.address(),
                                          .bits = pairs.bits.address(),
                                          .reversed =
                                              (pairs.reversed ? pairs.reversed : pairs.bits).address(),
                                          .transposed = pairs.transposed.address(),
                                          .firstSuper = first,
                                          .bitsUnits = pairs.bitsUnits,
                                          .chunkCount = chunkCount};
    transpose_.dispatch(cmd, transpose, shader::kSuperBlocks, count);
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
                                    .firstSuper = first,
                                    .bitsUnits = pairs.bitsUnits,
                                    .chunkCount = chunkCount,
                                    .reflectivity = settings.reflectivity,
                                    .distanceFactor = settings.distanceFactor};
    gather_.dispatch(cmd, gather, 2 * shader::kSuper, count);
    vk::barrier(cmd);
    const shader::ReducePush reduce{.supers = pairs.supers.address(),
                                    .partial = pairs.partial.address(),
                                    .ligOut = light.ligOut.address(),
                                    .firstSuper = first,
                                    .superCount = count,
                                    .patchCount = chunkCount * shader::kChunk};
    reduce_.dispatch(cmd, reduce, chunkCount);
}

void FinishPass::record(VkCommandBuffer cmd, const LightBuffers& light, uint32_t chunkCount,
                        bool rtrad) const {
    const shader::FinishPush push{.patches = light.patches.address(),
                                  .emission = light.emission.address(),
                                  .ligIn = light.ligIn.address(),
                                  .ligOut = light.ligOut.address(),
                                  .patchCount = chunkCount * shader::kChunk,
                                  .rtrad = rtrad ? 1u : 0u};
    program_.dispatch(cmd, push, chunkCount);
}

} // namespace relume
