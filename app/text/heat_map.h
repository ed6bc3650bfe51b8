#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "assets/images/float_image.h"

namespace relume {

/// Returns the display colour (sRGB, 0 to 1) for t in [0, 1]: from black over blue, red and yellow-green to
/// white, ever brighter, so that it reads in grey too [Green 2011, cubehelix].
glm::vec3 heatColour(double t);

/// Returns a round end of a scale that a few outliers do not stretch: the smallest of 1, 2 or 5 times a power
/// of ten that 99 % of the covered values do not exceed; 1 where all are 0.
double heatScale(const std::vector<float>& values, const std::vector<bool>& covered);

/// Returns `values` from 0 to `scale` as colours (linear, for writeImage), grey where nothing is covered.
FloatImage heatMap(uint32_t width, const std::vector<float>& values, const std::vector<bool>& covered,
                   double scale);

} // namespace relume
