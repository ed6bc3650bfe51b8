#include "bake/layers/dirty_chunks.h"

#include <algorithm>

namespace relume {
namespace {

using Kind = LightKey::Kind;

// A light's box grows by more than rounding moves its points by, as a share of where it is.
constexpr float kRounding = 1e-5f;

LightPlace grown(LightPlace place) {
    const glm::vec3 reach = glm::max(glm::abs(place.lo), glm::abs(place.hi));
    const glm::vec3 margin(kRounding * std::max({reach.x, reach.y, reach.z}));
    place.lo -= margin;
    place.hi += margin;
    return place;
}

LightPlace placeOfLamp(const Light& light, float reach) {
    const glm::vec3 at(light.transform[3]);
    glm::vec3 extent(light.radius);
    if (light.type == LightType::Directional) {
        // This is where it comes from; chords across the disc are shorter than the angle.
        const glm::vec3 from = glm::normalize(glm::vec3(light.transform[2]));
        extent = glm::vec3(0.5f * light.angle);
        return grown({LightPlace::Kind::Directions, reach * (from - extent), reach * (from + extent)});
    }
    if (light.type == LightType::Rectangle)
        extent = 0.5f * (light.size.x * glm::abs(glm::normalize(glm::vec3(light.transform[0]))) +
                         light.size.y * glm::abs(glm::normalize(glm::vec3(light.transform[1]))));
    return grown({LightPlace::Kind::Box, at - extent, at + extent});
}

LightPlace placeOfEmitter(const WorldMesh& mesh, const LightCacheKey& cacheKey) {
    LightPlace place{LightPlace::Kind::Box, glm::vec3(1e30f), glm::vec3(-1e30f)};
    for (size_t corner = 0; corner < mesh.positions.size(); ++corner) {
        if (mesh.instance[corner / 3] != cacheKey.instance || mesh.material[corner / 3] != cacheKey.material)
            continue;
        place.lo = glm::min(place.lo, mesh.positions[corner]);
        place.hi = glm::max(place.hi, mesh.positions[corner]);
    }
    return grown(place);
}

LightPlace placeOf(const MoveReach& moved, const LightCacheKey& cacheKey) {
    if (cacheKey.kind == Kind::Lamp) return placeOfLamp(cacheKey.light, moved.reach);
    if (cacheKey.kind == Kind::Emitter) return placeOfEmitter(moved.patches.scene.mesh, cacheKey);
    return {};
}

// Returns 1 for those chunks whose direct light of one light may change with what moved.
std::vector<uint8_t> chunksOf(const MoveReach& moved, const LightCacheKey& cacheKey) {
    const std::vector<uint32_t>& instances = moved.move.instances;
    const bool far = cacheKey.kind == Kind::Sky ||
                     (cacheKey.kind == Kind::Lamp && cacheKey.light.type == LightType::Directional);
    const bool itself = cacheKey.kind == Kind::Emitter &&
                        std::find(instances.begin(), instances.end(), cacheKey.instance) != instances.end();
    if (itself || (far && moved.farther)) return std::vector<uint8_t>(moved.patches.chunkCount(), 1);
    return chunksReached(moved.pool, moved.patches, placeOf(moved, cacheKey), moved.move);
}

// Marks neighbours of what is dirty, too, as it decides on their sample passes.
void growToParts(const TileParts& tileParts, std::vector<uint8_t>& dirty) {
    std::vector<uint8_t> parts(tileParts.count, 0);
    for (uint32_t i = 0; i < dirty.size(); ++i)
        if (dirty[i] == Layer::kDirty) tileParts.mark(i, parts);
    for (uint32_t i = 0; i < dirty.size(); ++i) {
        if (dirty[i] == 0 && tileParts.any(i, parts)) dirty[i] = Layer::kBeside;
        if (dirty[i] == Layer::kBegun && tileParts.any(i, parts)) dirty[i] = Layer::kBesideBegun;
    }
}

} // namespace

void markDirty(const MoveReach& moved, Layer& layer) {
    layer.dirty.resize(moved.patches.chunkCount(), 0);
    const auto add = [&](const LightCacheKey& cacheKey) {
        const std::vector<uint8_t> reached = chunksOf(moved, cacheKey);
        for (size_t i = 0; i < reached.size(); ++i)
            if (reached[i] != 0) layer.dirty[i] = Layer::kDirty;
    };
    if (layer.cacheKey.kind != Kind::Group) add(layer.cacheKey);
    for (const LightCacheKey& member : layer.cacheKey.members)
        add(member);
    growToParts(moved.parts, layer.dirty);
    layer.begun =
        layer.begun && std::find(layer.dirty.begin(), layer.dirty.end(), Layer::kDirty) == layer.dirty.end();
    if (std::count(layer.dirty.begin(), layer.dirty.end(), 0) == std::ssize(layer.dirty)) layer.dirty.clear();
}

} // namespace relume
