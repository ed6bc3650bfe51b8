#pragma once

#include "bake/base/shader_types.h"
#include "bake/vk/program.h"

namespace relume {

/// Sums on the device what kernels tell chunk by chunk: a few bytes are read back, not many for each chunk.
class ChunkSumPass {
public:
    explicit ChunkSumPass(const vk::Device& device) : program_(device, "sum_chunks") {}

    /// Values are float[groups][chunkCount][width], sums float[groups][width]. The caller writes the
    /// barriers.
    struct Work {
        VkDeviceAddress values = 0, sums = 0;
        uint32_t chunkCount = 0, width = 0, groups = 1;
    };
    void record(VkCommandBuffer cmd, const Work& work) const {
        const shader::ChunkSumPush push{
            .values = work.values, .sums = work.sums, .chunkCount = work.chunkCount, .width = work.width};
        program_.dispatch(cmd, push, work.width, work.groups);
    }

private:
    vk::ComputeProgram program_;
};

} // namespace relume
