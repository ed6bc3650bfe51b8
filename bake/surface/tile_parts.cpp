#include "bake/surface/tile_parts.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;

} // namespace

bool TileParts::any(uint32_t chunk, const std::vector<uint8_t>& marks) const {
    const std::span<const uint32_t> own = of(chunk);
    return std::any_of(own.begin(), own.end(), [&](uint32_t part) { return marks[part] != 0; });
}

void TileParts::mark(uint32_t chunk, std::vector<uint8_t>& marks) const {
    for (const uint32_t part : of(chunk))
        marks[part] = 1;
}

// Patches come tile by tile, so that a tile's parts follow one another.
TileParts makeTileParts(const PatchSet& patches) {
    const std::vector<shader::Patch>& all = patches.scene.patches;
    TileParts parts;
    parts.ofPatch.reserve(all.size());
    std::vector<std::pair<uint32_t, uint32_t>> here; // objects of this tile, and their parts
    uint32_t tile = UINT32_MAX;
    for (size_t i = 0; i < all.size(); ++i) {
        const uint32_t texel = shader::patchTexel(all[i].flags), size = patches.scene.size;
        const uint32_t own = texel / size / kTileTexels * size + texel % size / kTileTexels;
        if (own != tile) here.clear();
        tile = own;
        const uint32_t object = patches.instance[i];
        auto found =
            std::find_if(here.begin(), here.end(), [&](const auto& part) { return part.first == object; });
        if (found == here.end()) found = here.insert(here.end(), {object, parts.count++});
        parts.ofPatch.push_back(found->second);
        if (i % kChunk == 0) parts.first.push_back(static_cast<uint32_t>(parts.parts.size()));
        const auto chunk = parts.parts.begin() + parts.first.back();
        if (std::find(chunk, parts.parts.end(), found->second) == parts.parts.end())
            parts.parts.push_back(found->second);
    }
    parts.first.push_back(static_cast<uint32_t>(parts.parts.size()));
    return parts;
}

} // namespace relume
