#pragma once

#include <cmath>

#include "assets/base/error.h"

namespace relume {

/// Throws Error where the sums over all patches of their light or of its squares are not finite: then no
/// error can be told, and the light is no result. The bounds on lights (assets/model/scene_limits.h) leave
/// one cause: an analytic light of no extent right at a surface.
inline void requireFiniteLight(double light, double squares) {
    if (std::isfinite(light) && std::isfinite(squares)) return;
    throw Error(
        "the light is too bright for its error to be told: move lamps that are right at a surface away "
        "from it, give them a radius, or lower their intensity");
}

} // namespace relume
