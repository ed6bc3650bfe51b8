#pragma once

#include <cstdint>
#include <vector>

#include "bake/surface/patches.h"

namespace relume {

/// Tells which texels SewSeams (bake/output/lightmap.h) fills and from which neighbours, sorted by the chunks
/// whose light they depend on: what has to be filled again when the light of some chunks changes.
struct SeamPlan {
    uint32_t rings = 0;      // filled one after the other
    uint32_t chunkCount = 0; // of patches
    // An entry is a texel, and bits of its neighbours that are filled before it (shader::seamOffset); its
    // light is their mean. The entries of ring r (from 1 on) that depend on chunk c, through other fills or
    // at once, are fills[starts[at(r, c)]] .. fills[starts[at(r, c) + 1]]; a texel that depends on several
    // chunks is listed with each.
    std::vector<glm::uvec2> fills;
    std::vector<uint32_t> starts;

    size_t at(uint32_t ring, uint32_t chunk) const { return size_t{ring - 1} * chunkCount + chunk; }
};

/// Plans the fills of all texels that makeLightmap fills.
SeamPlan buildSeamPlan(const PatchSet& patches, uint32_t rings);

/// Returns the texel that shows each patch, padding included; shader::kNoTexel where none does: for patches
/// that send nothing because they lie inside something, back sides, patches of charts that cover no texel
/// centre where another patch has their texel, and padding.
std::vector<uint32_t> shownTexels(const PatchSet& patches);

} // namespace relume
