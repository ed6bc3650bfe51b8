#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/surface/patches.h"

namespace relume {

/// Tells which patches are neighbours: those of one tile (8 x 8 texels) and one object make a part. They stay
/// together whatever other objects do.
struct TileParts {
    std::vector<uint32_t> ofPatch; // padding, too
    uint32_t count = 0;

    /// Returns the parts of a chunk's patches, each once.
    std::span<const uint32_t> of(uint32_t chunk) const {
        return std::span(parts).subspan(first[chunk], first[chunk + 1] - first[chunk]);
    }
    /// Tells whether any of the chunk's parts is marked (not 0); each part has one mark.
    bool any(uint32_t chunk, const std::vector<uint8_t>& marks) const;
    void mark(uint32_t chunk, std::vector<uint8_t>& marks) const;

    std::vector<uint32_t> parts, first; // of chunk c: parts[first[c] .. first[c + 1] - 1]
};
TileParts makeTileParts(const PatchSet& patches);

} // namespace relume
