#pragma once

#include <functional>
#include <span>
#include <vector>

#include "bake/base/chunk_order.h"
#include "bake/surface/patches.h"
#include "bake/trace/tracer.h"

namespace relume {

/// The things that a search for patches that lie inside something works with.
struct InsideSearch {
    const vk::Device& device;
    Tracer& tracer;
    const PatchSet& patches;
    uint32_t samples;               // directions of each patch, a multiple of 8
    std::vector<ChunkRange> chunks; // that are asked, ascending
    // Hears what all directions of some chunks meet, links[chunk][sample][64], in the order of the chunks;
    // where nobody hears it, patches whose first directions have told enough are not asked further.
    std::function<void(uint32_t firstChunk, std::span<const uint32_t> links)> onLinks;
    std::function<void(double done)> onBatch; // before each batch; what it throws ends the search
};

/// Returns the patches of these chunks that lie inside something (liesInside), ascending. It works in short
/// batches of closest hits.
std::vector<uint32_t> findInside(const InsideSearch& search);
/// Returns the device bytes that it takes, on a software device or a GPU.
uint64_t insideBytes(uint32_t chunks, uint32_t samples, bool software);

} // namespace relume
