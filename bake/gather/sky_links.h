#pragma once

#include "bake/solver/solver.h"

namespace relume {

/// Tells whether links may bring the sky's light: where a bounce more or less does not matter, every patch
/// has links of its own, and the sky is of one radiance. Else rays are sent to it, as to other lights.
inline bool linksMaySeeSky(const Sky& sky, const SolverSettings& settings) {
    return settings.passes == 0 && settings.links.indirectScale == 1 && sky.pixels.empty();
}
/// Tells whether they do: the sky shines, too.
inline bool linksSeeSky(const Sky& sky, const SolverSettings& settings) {
    return linksMaySeeSky(sky, settings) && sky.shines();
}

} // namespace relume
