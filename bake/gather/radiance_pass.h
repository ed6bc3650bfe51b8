#pragma once

#include "bake/base/chunk_dispatch.h"
#include "bake/solver/transport.h"
#include "bake/surface/light_buffers.h"
#include "bake/vk/program.h"

namespace relume {

/// Makes what each patch of some chunks sends and notes which of these send at all. It reads ligIn.
class RadiancePass {
public:
    explicit RadiancePass(const vk::Device& device) : program_(device, "radiance") {}
    void record(VkCommandBuffer cmd, const LightBuffers& light, const TransportSettings& settings,
                const SomeChunks& chunks = {}) const;

private:
    vk::ComputeProgram program_;
};

} // namespace relume
