#pragma once

#include <functional>

#include "bake/base/shader_types.h"

namespace relume {

/// How wide indirect light is smoothed: as its error is least, learnt from the result itself.
struct SmoothingWidth {
    double sigma = 2.0;    // [texels]
    double curvature = -1; // of the light, squared: bias over width^4; negative: not known yet

    /// Makes the result of `resolve` (by a width) with the best of a few widths, the present one first, and
    /// leaves it there. Returns that one's sums.
    shader::ResolveSums settle(const std::function<shader::ResolveSums(double)>& resolve);
    /// The width that suits what another one has shown.
    void adapt(const shader::ResolveSums& sums);
};

/// Square of what smoothing leaves and adds, R, G and B of all patches together.
double smoothedVariance(const shader::ResolveSums& sums);

} // namespace relume
