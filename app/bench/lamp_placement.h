#pragma once

#include <cstdint>
#include <vector>

#include "assets/model/scene.h"
#include "bake/surface/trace_scene.h"

namespace relume {

/// Places for lamps in a scene that may have none. They are the same on every machine.
struct LampPlaces {
    std::vector<glm::vec3> positions; // [m], the first ones are the same however many there are
    glm::vec3 moved{0.0f};            // [m]: the first one, 10 % of the diagonal towards the bounds' middle
    float diagonal = 0;               // of the scene's bounds [m]
};

/// Returns points of the Halton sequence in the scene's bounds from which fronts of surfaces with lightmap
/// UVs are seen, and that are neither inside something nor close to a surface; the first one's moved place is
/// like that, too. count > 0. Throws Error when there are not so many.
LampPlaces placeLamps(const TraceScene& scene, uint32_t count);

/// Returns a white sphere at one of them whose light at a quarter of the diagonal is 1 cd/m^2 on a white
/// diffuse surface.
Light lampAt(const LampPlaces& places, uint32_t index);
/// Tells people what placeLamps() and lampAt() do.
const char* lampPlacementText();

} // namespace relume
