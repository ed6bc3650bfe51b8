#pragma once

#include <cstdint>
#include <vector>

#include "assets/model/scene.h"

namespace relume::gltf {

/// Returns an image as the bytes of a PNG file, without alpha where it is opaque. Throws Error, without the
/// file's name, where the image has no pixels.
std::vector<uint8_t> encodePng(const Image& image);

} // namespace relume::gltf
