#pragma once

#include <vector>

#include "bake/lights/light_source.h"

namespace relume {

/// The lights that have one layer: a light, or several that there is no memory to tell apart.
struct LightGroup {
    LightSource source;               // a group's weight is 1, and 0 where none of it shines
    std::vector<LightSource> members; // of a group, in the order of lightSources(); empty: one light
};

/// Lights are grouped only where there is room for so many layers, of which one is spare.
constexpr uint64_t kLeastRoom = 3;

/// Returns the lights in no more layers than there is room for, which is kLeastRoom or more. Each is by
/// itself where all find room. Else one layer is kept spare and one holds "the rest". Those before it go to
/// suns (where these would take more than half, they share one, "directional"), then to the sky, then to the
/// others in their order. Who shares a layer depends on nothing but which lights there are. Groups come last.
std::vector<LightGroup> groupLights(const Scene& scene, const std::vector<LightSource>& sources,
                                    uint64_t room);

/// Returns the group that a light is in; nullptr where it is in none.
const LightGroup* groupWith(const std::vector<LightGroup>& groups, const LightKey& light);

} // namespace relume
