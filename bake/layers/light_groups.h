#pragma once

#include <vector>

#include "bake/lights/light_source.h"

namespace relume {

/// What has one layer: a light, or several that there is no memory to tell apart.
struct LightGroup {
    LightSource source;               // a group's weight is 1, and 0 where none of it shines
    std::vector<LightSource> members; // of a group, in the order of lightSources(); empty: one light
};

/// Layers of which one is spare that lights can be grouped in; with room for fewer they are not.
constexpr uint64_t kLeastRoom = 3;

/// The lights in no more layers than there is room for, which is kLeastRoom or more: each by itself where all
/// find room. Else one is kept spare and one holds "the rest": those before it go to suns (where these would
/// take more than half, they share one, "directional"), then the sky, then the others in their order. Who
/// shares a layer depends on nothing but which lights there are. Groups come last.
std::vector<LightGroup> groupLights(const Scene& scene, const std::vector<LightSource>& sources,
                                    uint64_t room);

/// The one that a light is in; nullptr: it is in none.
const LightGroup* groupWith(const std::vector<LightGroup>& groups, const LightKey& light);

} // namespace relume
