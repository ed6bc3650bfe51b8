#include "bake/layers/light_groups.h"

#include "assets/base/error.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

using Kind = LightKey::Kind;

constexpr uint32_t kDirectional = 0, kRest = 1; // LightKey::index of groups

LightGroup makeGroup(uint32_t index, std::vector<LightSource> members) {
    LightSource source{
        {Kind::Group, index, 0}, index == kDirectional ? "directional" : "rest", glm::vec3(1.0f)};
    return {std::move(source), std::move(members)};
}

bool isSun(const Scene& scene, const LightSource& source) {
    return source.key.kind == Kind::Lamp && scene.lights[source.key.index].type == LightType::Directional;
}

// Suns and the sky light most of a scene that has them, and are what its mood is made with: they come first.
std::vector<size_t> inOrderOfRank(const Scene& scene, const std::vector<LightSource>& sources) {
    std::vector<size_t> order(sources.size());
    for (size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    const auto rank = [&](size_t i) {
        return isSun(scene, sources[i]) ? 0 : sources[i].key.kind == Kind::Sky ? 1 : 2;
    };
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return rank(a) < rank(b); });
    return order;
}

// Names the group as no light is named: lights keep their names whatever there is memory for.
void nameApart(LightSource& group, const std::vector<LightSource>& sources) {
    const std::string name = group.name;
    const auto taken = [&] {
        return std::any_of(sources.begin(), sources.end(),
                           [&](const LightSource& source) { return source.name == group.name; });
    };
    for (uint32_t n = 2; taken(); ++n)
        group.name = name + " " + std::to_string(n);
}

} // namespace

std::vector<LightGroup> groupLights(const Scene& scene, const std::vector<LightSource>& sources,
                                    uint64_t room) {
    std::vector<LightGroup> groups;
    if (sources.size() <= room) {
        for (const LightSource& source : sources)
            groups.push_back({source, {}});
        return groups;
    }
    ASSERT(room >= kLeastRoom);
    const std::vector<size_t> order = inOrderOfRank(scene, sources);
    const auto suns = static_cast<size_t>(std::count_if(
        sources.begin(), sources.end(), [&](const LightSource& source) { return isSun(scene, source); }));
    uint64_t left = room - 2; // beside the spare one and the rest's
    std::vector<LightSource> directional, rest;
    std::vector<bool> alone(sources.size(), false);
    const bool together = suns > std::max<uint64_t>(1, left / 2);
    if (together) --left;
    const size_t others = sources.size() - (together ? suns : 0);
    if (others == left + 1) ++left; // a rest of one is a light
    for (const size_t i : order) {
        if ((together && isSun(scene, sources[i])) || left == 0) continue;
        alone[i] = true;
        --left;
    }
    for (size_t i = 0; i < sources.size(); ++i) {
        if (alone[i])
            groups.push_back({sources[i], {}});
        else
            (together && isSun(scene, sources[i]) ? directional : rest).push_back(sources[i]);
    }
    if (!directional.empty()) groups.push_back(makeGroup(kDirectional, std::move(directional)));
    if (!rest.empty()) groups.push_back(makeGroup(kRest, std::move(rest)));
    for (LightGroup& group : groups)
        if (!group.members.empty()) nameApart(group.source, sources);
    return groups;
}

const LightGroup* groupWith(const std::vector<LightGroup>& groups, const LightKey& light) {
    for (const LightGroup& group : groups)
        for (const LightSource& member : group.members)
            if (member.key == light) return &group;
    return nullptr;
}

} // namespace relume
