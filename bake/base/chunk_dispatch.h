#pragma once

#include <algorithm>

#include "bake/vk/program.h"

namespace relume {

/// One workgroup per chunk, or whatever there are so many of, for kernels that count them in y, too.
template<typename Push>
void dispatchChunks(const vk::ComputeProgram& program, VkCommandBuffer cmd, const Push& push,
                    uint32_t chunks) {
    constexpr uint32_t kMaxX = 32768; // workgroups in x, below every device's limit
    const uint32_t x = std::min(chunks, kMaxX);
    program.dispatch(cmd, push, x, (chunks + x - 1) / x);
}

} // namespace relume
