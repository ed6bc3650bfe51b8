#include "bake/layers/wanted_layers.h"

#include "assets/base/log.h"
#include "bake/layers/light_groups.h"
#include "bake/surface/light_buffers.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;

// Tells whether a light of this cache key is among those that shine in the group.
bool isIn(const LightCacheKey& group, LightCacheKey light) {
    light.surfaces = light.objects = 0; // the group has them
    return std::find(group.members.begin(), group.members.end(), light) != group.members.end();
}

bool isDark(const LightSource& source) {
    return source.weight == glm::vec3(0.0f);
}

// Tells whether the wanted layer has its light in a group that nobody took, or is a new group, which has it
// once it is baked.
bool standsIn(const LightCacheKey& cacheKey, bool isNew, const std::vector<std::unique_ptr<Layer>>& left) {
    const bool group = cacheKey.kind == LightKey::Kind::Group;
    const bool among = std::any_of(left.begin(), left.end(), [&](const std::unique_ptr<Layer>& layer) {
        const Layer* shown = layer->shown();
        const auto holds = [&](const LightCacheKey& light) { return isIn(shown->cacheKey, light); };
        return shown && (group ? std::any_of(cacheKey.members.begin(), cacheKey.members.end(), holds)
                               : holds(cacheKey));
    });
    return among || (group && isNew);
}

// Returns the lights of the scene; with names those of them.
std::vector<LightSource> namedSources(const Scene& scene, std::span<const std::string> names) {
    std::vector<LightSource> sources = lightSources(scene);
    if (names.empty()) return sources;
    std::erase_if(sources, [&](const LightSource& source) {
        return std::find(names.begin(), names.end(), source.name) == names.end();
    });
    return sources;
}

} // namespace

std::vector<WantedLayer> wantedLayers(const Scene& scene, const LightMix& mix, uint64_t room,
                                      const SceneState& state, std::span<const std::string> lights) {
    std::vector<WantedLayer> wanted;
    const auto weigh = [&](LightSource& source) {
        if (!mix.shines(source.key)) source.weight = glm::vec3(0.0f);
    };
    for (LightGroup& group : groupLights(scene, namedSources(scene, lights), room)) {
        std::vector<LightSource>& members = group.members;
        std::for_each(members.begin(), members.end(), weigh);
        if (members.empty())
            weigh(group.source);
        else if (std::all_of(members.begin(), members.end(), isDark))
            group.source.weight = glm::vec3(0.0f);
        LightCacheKey cacheKey = cacheKeyOf(scene, group);
        cacheKey.surfaces = state.surfaces;
        cacheKey.objects = state.objects;
        wanted.push_back({std::move(cacheKey), std::move(group.source), std::move(members)});
    }
    return wanted;
}

bool isRegrouped(const Layer& layer, const std::vector<WantedLayer>& wanted) {
    return layer.isGroup() || std::any_of(wanted.begin(), wanted.end(), [&](const WantedLayer& group) {
               return isIn(group.cacheKey, layer.cacheKey);
           });
}

StandInPlan planStandIn(const std::vector<WantedLayer>& wanted,
                        const std::vector<std::unique_ptr<Layer>>& taken,
                        const std::vector<std::unique_ptr<Layer>>& left) {
    StandInPlan plan;
    for (size_t i = 0; i < wanted.size(); ++i) {
        const LightCacheKey& cacheKey = wanted[i].cacheKey;
        plan.covered.push_back(standsIn(cacheKey, !taken[i], left));
        plan.regroups = plan.regroups || (plan.covered.back() && cacheKey.kind != LightKey::Kind::Group);
    }
    for (const std::unique_ptr<Layer>& layer : left) {
        if (!layer->shown() || layer->covered || !layer->shines()) continue;
        bool joins = false;
        for (size_t i = 0; i < wanted.size(); ++i)
            joins = joins || (plan.covered[i] && isIn(wanted[i].cacheKey, layer->cacheKey));
        plan.regroups = plan.regroups || joins;
        if (joins || layer->isGroup()) plan.sum.push_back(layer.get());
    }
    if (!plan.regroups) plan.covered.assign(wanted.size(), false);
    return plan;
}

uint64_t layerRoom(const PatchSet& patches, uint64_t bytes) {
    return bytes / (2 * LightBuffers::lightBytes(patches));
}

std::string layerProblem(const Scene& scene, const PatchSet& patches, uint64_t bytes,
                         std::span<const std::string> lights) {
    const size_t count = namedSources(scene, lights).size();
    const uint64_t room = layerRoom(patches, bytes);
    const bool named = !lights.empty();
    if (count <= room || (room >= kLeastRoom && !named)) return "";
    const bool grouped = count > kLeastRoom && !named;
    const uint64_t needed = (grouped ? kLeastRoom : count) * 2 * LightBuffers::lightBytes(patches);
    return fmt::format("layers of {} lights take {:.1f} GiB{}, {:.1f} may be taken: {}", count,
                       static_cast<double>(needed) / kGiB, grouped ? " in groups" : "",
                       static_cast<double>(bytes) / kGiB,
                       named ? "name fewer lights, or give more --layer-memory"
                             : "use a smaller lightmap, or bake without layers");
}

} // namespace relume
