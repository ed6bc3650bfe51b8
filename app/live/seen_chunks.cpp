#include "app/live/seen_chunks.h"

#include "renderer/shader_types.h"

#include <algorithm>

namespace relume {

std::vector<uint8_t> seenChunks(const TraceScene& scene, std::span<const uint32_t> tiles) {
    constexpr uint32_t kEdge = shader::kTileTexels;
    const uint32_t perRow = (scene.size + kEdge - 1) / kEdge;
    std::vector<uint8_t> seen(scene.chunkCount(), 0);
    for (const uint32_t tile : tiles) {
        const uint32_t left = tile % perRow * kEdge, top = tile / perRow * kEdge;
        for (uint32_t y = top; y < std::min(top + kEdge, scene.size); ++y) {
            for (uint32_t x = left; x < std::min(left + kEdge, scene.size); ++x) {
                const uint32_t patch = scene.texelToPatch[size_t{y} * scene.size + x];
                if (patch != shader::kNoPatch) seen[patch / shader::kChunk] = 1;
            }
        }
    }
    return seen;
}

} // namespace relume
