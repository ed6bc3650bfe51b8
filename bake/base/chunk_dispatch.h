#pragma once

#include <algorithm>

#include "bake/vk/program.h"

namespace relume {

/// Dispatches one workgroup per chunk, or per item of any list, for kernels that count workgroups in y, too.
template<typename Push>
void dispatchChunks(const vk::ComputeProgram& program, VkCommandBuffer cmd, const Push& push,
                    uint32_t chunks) {
    constexpr uint32_t kMaxX = 32768; // workgroups in x, below every device's limit
    const uint32_t x = std::min(chunks, kMaxX);
    program.dispatch(cmd, push, x, (chunks + x - 1) / x);
}

} // namespace relume
