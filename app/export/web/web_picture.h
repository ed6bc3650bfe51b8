#pragma once

#include <string>

#include "assets/images/float_image.h"
#include "assets/model/scene.h"

namespace relume {

/// Returns a picture as WebP without loss, also of the colours of transparent pixels. Throws Error where it
/// is larger than WebP allows (16383 pixels) or the memory is full.
std::string webpOf(const Image& image);

/// Returns R, G and B (linear) as WebP of a quality at which no difference is seen. Throws Error, naming the
/// picture `name`.
std::string smallWebpOf(const FloatImage& image, const std::string& name);

} // namespace relume
