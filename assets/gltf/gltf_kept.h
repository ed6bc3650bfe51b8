#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "assets/model/scene.h"

namespace relume::gltf {

struct Build;

/// Finds the picture of a texture that is kept for files that are written: an image of the file that is read,
/// PNG, JPEG or WebP. Returns false where it is missing or none of these. A picture that stands beside the
/// file is not read, only looked at.
bool keepImage(const Build& build, size_t image, KeptTexture& texture);

/// Returns the picture of a kept texture as PNG or JPEG. Throws Error where it cannot be read any more.
std::vector<uint8_t> keptPicture(const KeptTexture& texture);

} // namespace relume::gltf
