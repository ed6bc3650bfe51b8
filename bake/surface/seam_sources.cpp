#include "bake/surface/seam_sources.h"

#include <bit>

namespace relume {
namespace {

using shader::kCoverEdge;

// Returns the columns (or rows) of a neighbour's cells that lie less than a texel from the texel's middle in
// this direction, a bit each: a bilinear filter reads no farther.
uint32_t nearCells(int offset) {
    constexpr uint32_t kAll = (1u << kCoverEdge) - 1, kLow = (1u << kCoverEdge / 2) - 1;
    constexpr uint32_t kHigh = kAll & ~(kLow << 1 | 1u);
    return offset == 0 ? kAll : offset > 0 ? kLow : kHigh;
}

} // namespace

uint32_t SeamSources::patchAt(uint32_t texel, uint32_t neighbour) const {
    const glm::ivec2 by = shader::seamOffset(neighbour);
    const auto size = static_cast<int>(set_.scene.size);
    return set_.scene.texelToPatch[static_cast<size_t>(static_cast<int>(texel) + by.y * size + by.x)];
}

// Tells whether filters read the texel for the chart of its neighbour, by what that covers of its own texel.
bool SeamSources::reads(uint32_t patch, uint32_t neighbour) const {
    const uint32_t cells = set_.coverCells[patch];
    if ((cells & shader::kCoverCells) == 0) return true; // nobody knows
    const glm::ivec2 by = shader::seamOffset(neighbour);
    const uint32_t columns = nearCells(by.x), rows = nearCells(by.y);
    for (uint32_t row = 0; row < kCoverEdge; ++row)
        if ((rows >> row & 1u) != 0 && (cells >> row * kCoverEdge & columns) != 0) return true;
    return false;
}

uint32_t SeamSources::choose(uint32_t texel, uint32_t among) const {
    if (set_.scene.rtrad || set_.coverCells.empty()) return among;
    const uint32_t own = set_.scene.texelToPatch[texel];
    uint32_t chosen = 0;
    for (uint32_t left = among; left != 0; left &= left - 1) {
        const auto neighbour = static_cast<uint32_t>(std::countr_zero(left));
        const uint32_t patch = patchAt(texel, neighbour);
        const bool serves = own == shader::kNoPatch
                                ? reads(patch, neighbour)
                                : set_.scene.patchChart[patch] == set_.scene.patchChart[own];
        if (serves) chosen |= 1u << neighbour;
    }
    return chosen != 0 ? chosen : among;
}

} // namespace relume
