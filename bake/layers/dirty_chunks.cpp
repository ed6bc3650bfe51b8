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

LightPlace placeOfEmitter(const WorldMesh& mesh, const LightPattern& pattern) {
    LightPlace place{LightPlace::Kind::Box, glm::vec3(1e30f), glm::vec3(-1e30f)};
    for (size_t corner = 0; corner < mesh.positions.size(); ++corner) {
        if (mesh.instance[corner / 3] != pattern.instance || mesh.material[corner / 3] != pattern.material)
            continue;
        place.lo = glm::min(place.lo, mesh.positions[corner]);
        place.hi = glm::max(place.hi, mesh.positions[corner]);
    }
    return grown(place);
}

LightPlace placeOf(const MoveReach& moved, const LightPattern& pattern) {
    if (pattern.kind == Kind::Lamp) return placeOfLamp(pattern.light, moved.reach);
    if (pattern.kind == Kind::Emitter) return placeOfEmitter(moved.patches.scene.mesh, pattern);
    return {};
}

// Returns 1 for those chunks whose direct light of one light may change with what moved.
std::vector<uint8_t> chunksOf(const MoveReach& moved, const LightPattern& pattern) {
    const std::vector<uint32_t>& instances = moved.move.instances;
    const bool far = pattern.kind == Kind::Sky ||
                     (pattern.kind == Kind::Lamp && pattern.light.type == LightType::Directional);
    const bool itself = pattern.kind == Kind::Emitter &&
                        std::find(instances.begin(), instances.end(), pattern.instance) != instances.end();
    if (itself || (far && moved.farther)) return std::vector<uint8_t>(moved.patches.chunkCount(), 1);
    return chunksReached(moved.pool, moved.patches, placeOf(moved, pattern), moved.move);
}

// Marks neighbours of what is dirty, too, as it decides on their sample passes.
void growToParts(const TileParts& tileParts, std::vector<uint8_t>& stale) {
    std::vector<uint8_t> parts(tileParts.count, 0);
    for (uint32_t i = 0; i < stale.size(); ++i)
        if (stale[i] == Layer::kStale) tileParts.mark(i, parts);
    for (uint32_t i = 0; i < stale.size(); ++i) {
        if (stale[i] == 0 && tileParts.any(i, parts)) stale[i] = Layer::kBeside;
        if (stale[i] == Layer::kBegun && tileParts.any(i, parts)) stale[i] = Layer::kBesideBegun;
    }
}

} // namespace

void markDirty(const MoveReach& moved, Layer& layer) {
    layer.stale.resize(moved.patches.chunkCount(), 0);
    const auto add = [&](const LightPattern& pattern) {
        const std::vector<uint8_t> reached = chunksOf(moved, pattern);
        for (size_t i = 0; i < reached.size(); ++i)
            if (reached[i] != 0) layer.stale[i] = Layer::kStale;
    };
    if (layer.pattern.kind != Kind::Group) add(layer.pattern);
    for (const LightPattern& member : layer.pattern.members)
        add(member);
    growToParts(moved.parts, layer.stale);
    layer.begun =
        layer.begun && std::find(layer.stale.begin(), layer.stale.end(), Layer::kStale) == layer.stale.end();
    if (std::count(layer.stale.begin(), layer.stale.end(), 0) == std::ssize(layer.stale)) layer.stale.clear();
}

} // namespace relume
