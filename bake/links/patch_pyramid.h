#pragma once

#include <cstdint>
#include <vector>

#include "bake/surface/patches.h"

namespace relume {

/// Groups of a chart's patches that lie in the same 2x2, 4x4, ... texels of the lightmap: light is averaged
/// over them. Patches and nodes share one numbering: nodes come behind the patches, padding included.
struct PatchPyramid {
    std::vector<uint32_t> parents;          // per patch: the node that it is part of; kNoPatch: none
    std::vector<shader::PyramidNode> nodes; // two to four children each, all of lower levels
    std::vector<uint32_t> levelEnds;        // per level, the smallest first: nodes up to its end
};

/// Builds nodes that never mix charts, nor patches whose normals are too unlike. Patches that send nothing
/// because they lie inside something, back sides and those of charts that cover no texel are in none. size
/// grows from child to parent.
PatchPyramid buildPatchPyramid(const PatchSet& patches);

} // namespace relume
