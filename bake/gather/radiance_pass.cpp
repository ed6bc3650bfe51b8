#include "bake/gather/radiance_pass.h"

#include "bake/base/chunk_dispatch.h"

namespace relume {

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

} // namespace relume
