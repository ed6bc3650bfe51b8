#pragma once

#include <string>

#include "assets/images/float_image.h"

namespace relume {

/// Throws Error, naming the first texel that is not a finite number: no result is written with such a texel.
void requireFinite(const FloatImage& image, const std::string& name);

} // namespace relume
