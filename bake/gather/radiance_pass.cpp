#include "bake/gather/radiance_pass.h"

namespace relume {

void RadiancePass::record(VkCommandBuffer cmd, const LightBuffers& light, const TransportSettings& settings,
                          const SomeChunks& chunks) const {
    forRuns(chunks, light.chunkCount, [&](const ChunkRange& run) {
        const uint64_t first = uint64_t{run.first} * shader::kChunk, vec4s = first * sizeof(glm::vec4);
        const shader::RadiancePush push{.patches = light.patches.address() + first * sizeof(shader::Patch),
                                        .albedo = light.albedo.address() + vec4s,
                                        .emission = light.emission.address() + vec4s,
                                        .ligIn = light.ligIn.address() + vec4s,
                                        .radiance = light.radiance.address() + vec4s,
                                        .chunkSends =
                                            light.chunkSends.address() + run.first * sizeof(uint32_t),
                                        .chunkCount = run.count,
                                        .reflectivity = settings.reflectivity,
                                        .rtrad = settings.rtrad ? 1u : 0u,
                                        .all = settings.allSend ? 1u : 0u,
                                        .reflected = settings.reflectedOnly ? 1u : 0u};
        dispatchChunks(program_, cmd, push, run.count);
    });
}

} // namespace relume
