#pragma once

#include <cstdint>
#include <vector>

#include "bake/surface/patches.h"

namespace relume {

/// The fewer patches that links are followed from, and how the light of all is made of theirs.
struct CoarsePatches {
    // They are copies of patches in tiles of 8x8 windows, padded to whole chunks with patches that do not
    // send. The texel in their flags, the key of their random numbers, is that of the window in the coarse
    // grid.
    std::vector<shader::Patch> receivers;
    std::vector<shader::CoarseTaps> taps; // per patch of the set; weights sum to 1, or are 0 where no light
                                          // is received: padding, back sides, inside something
    std::vector<shader::CoarseNeighbours> neighbours; // per receiver, padding included
    uint32_t count = 0;                               // receivers without padding

    uint32_t chunkCount() const { return static_cast<uint32_t>(receivers.size() / shader::kChunk); }
};

/// Makes one receiver for each part of a window of scale x scale texels that belongs to one chart and is
/// roughly even, and for each patch of a chart that covers no texel. Light is interpolated within charts
/// between up to four receivers, by place in the chart, height over the plane and normal. scale is 2 or 4.
CoarsePatches buildCoarsePatches(const PatchSet& patches, uint32_t scale);

} // namespace relume
