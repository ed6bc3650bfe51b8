#include "bake/layers/layer.h"

#include "bake/base/shader_types.h"
#include "bake/gather/sample_plan.h"

#include <algorithm>

namespace relume {
namespace {

LightCacheKey cacheKeyOf(const Scene& scene, const LightKey& key) {
    LightCacheKey cacheKey{.kind = key.kind};
    switch (key.kind) {
    case LightKey::Kind::Emitter:
        cacheKey.instance = key.index;
        cacheKey.material = key.material;
        break;
    case LightKey::Kind::Lamp:
        cacheKey.light = scene.lights[key.index];
        cacheKey.light.name.clear();
        cacheKey.light.color = glm::vec3(1.0f);
        cacheKey.light.intensity = 1.0f;
        cacheKey.light.node = -1;
        cacheKey.light.preview = false;
        break;
    case LightKey::Kind::Sky:
        cacheKey.rotation = scene.sky.rotation;
        cacheKey.file = scene.sky.file;
        break;
    case LightKey::Kind::Group:
        break;
    }
    return cacheKey;
}

bool alike(const LightCacheKey& group, size_t i, const LightCacheKey& other, size_t k) {
    return group.members[i] == other.members[k] && group.weights[i] == other.weights[k];
}

// Counts how many of a group's members are alike from the start on.
size_t alikeFromTheStart(const LightCacheKey& a, const LightCacheKey& b) {
    size_t i = 0;
    while (i < std::min(a.members.size(), b.members.size()) && alike(a, i, b, i))
        ++i;
    return i;
}

// Tells what changed. One name stands for it: a member that is lit otherwise, or one that is off or gone.
std::string groupReason(const Layer& layer, const Layer& shown) {
    const LightCacheKey &now = layer.cacheKey, &then = shown.cacheKey;
    if (now.members == then.members && now.weights == then.weights) return "";
    const size_t first = alikeFromTheStart(now, then);
    const bool fewer = now.members.size() < then.members.size();
    const std::vector<LightSource>& members = fewer ? shown.members : layer.members;
    size_t lit = 0;
    for (const LightSource& member : members) {
        if (member.weight == glm::vec3(0.0f)) continue;
        if (lit++ == first)
            return "light '" + member.name + "' in '" + layer.source.name + "' " +
                   (fewer ? "is off" : "changed");
    }
    return "lights in '" + layer.source.name + "' changed";
}

} // namespace

LightCacheKey cacheKeyOf(const Scene& scene, const LightGroup& group) {
    LightCacheKey cacheKey = cacheKeyOf(scene, group.source.key);
    for (const LightSource& member : group.members) {
        if (member.weight == glm::vec3(0.0f)) continue;
        cacheKey.members.push_back(cacheKeyOf(scene, member.key));
        cacheKey.weights.push_back(member.weight);
    }
    return cacheKey;
}

// The first step is that of the first level, which is in haste.
uint32_t nextDirectStep(uint32_t samplePasses) {
    constexpr uint32_t kFirst = 2;
    return samplePasses < kFirst ? kFirst : onLadder(samplePasses + 1.0, true);
}

double Layer::directShare() const {
    if (penumbra.empty()) return 1.0;
    const auto within = static_cast<double>(std::count(penumbra.begin(), penumbra.end(), 1));
    const double share = within / static_cast<double>(penumbra.size());
    return share + (1.0 - share) / shader::kPenumbraSamplePasses;
}

uint32_t Layer::rays() const {
    uint32_t rays = 0;
    for (const DirectPart& part : parts)
        rays += part.rays;
    return rays;
}

double Layer::raysWeighed(double picked) const {
    double rays = 0;
    for (const DirectPart& part : parts)
        rays += (part.picks ? picked : 1.0) * part.rays;
    return rays;
}

bool allLit(const std::vector<std::unique_ptr<Layer>>& layers) {
    return std::all_of(layers.begin(), layers.end(), [](const std::unique_ptr<Layer>& layer) {
        return !layer->shines() || layer->directSamplePasses > 0;
    });
}

std::string staleReason(const Layer& layer) {
    if (layer.has() || layer.source.weight == glm::vec3(0.0f)) return "";
    const bool group = layer.source.key.kind == LightKey::Kind::Group;
    const std::string light = (group ? "group '" : "light '") + layer.source.name + "' ";
    const Layer* shown = layer.shown();
    if (!shown) return light + "is not baked yet";
    const LightCacheKey &now = layer.cacheKey, &then = shown->cacheKey;
    if (group)
        if (std::string reason = groupReason(layer, *shown); !reason.empty()) return reason;
    if (now.light.transform != then.light.transform) return light + "moved";
    if (now.rotation != then.rotation) return light + "turned";
    LightCacheKey recoloured = then;
    recoloured.surfaces = now.surfaces;
    if (recoloured == now) return light + "meets surfaces of other colours";
    recoloured.objects = now.objects;
    return light + (recoloured == now ? "shines on objects that moved" : "has another form");
}

} // namespace relume
