#pragma once

#include <cstdint>
#include <string>

#include "assets/images/float_image.h"
#include "assets/model/scene.h"

namespace relume {

constexpr uint32_t kMostWebp = 16383; // pixels along a side of a WebP picture

/// Returns a picture as WebP without loss, also of the colours of transparent pixels. Throws Error where it
/// is larger than WebP allows or the memory is full.
std::string webpOf(const Image& image);

/// Returns R, G and B (linear) as WebP of a quality at which no difference is seen. Throws Error, naming the
/// picture `name`.
std::string smallWebpOf(const FloatImage& image, const std::string& name);

} // namespace relume
