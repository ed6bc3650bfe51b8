#pragma once

#include <functional>

#include "bake/base/shader_types.h"

namespace relume {

/// Tells how wide indirect light is smoothed: as its error is least, which is learnt from the result itself.
struct SmoothingWidth {
    double sigma = 2.0;    // [texels]
    double curvature = -1; // of the light, squared: bias over width^4; negative: not known yet

    /// Makes the result by `resolve` (which takes a width) with the best of a few widths, the present one
    /// first, and leaves it there. Returns that one's sums.
    shader::ResolveSums converge(const std::function<shader::ResolveSums(double)>& resolve);
    /// Changes to the width that suits what the sums of another one have shown.
    void adapt(const shader::ResolveSums& sums);
};

/// Returns the square of what smoothing leaves and adds, R, G and B of all patches together.
double smoothedVariance(const shader::ResolveSums& sums);

} // namespace relume
