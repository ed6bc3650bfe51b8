#pragma once

#include <cstdint>
#include <string>

#include "assets/model/scene.h"

namespace relume {

/// Returns the picture of a texture with at most `most` pixels along each side, for a device that takes no
/// more. A longer side is cut by itself, as UVs stretch the picture anyway. Each pixel is the mean of the
/// area that it covers. Colours of `srgb` are averaged as light, and alpha as it is.
Image shrunkTo(uint32_t most, const Image& image, bool srgb);

/// Does the same to the pixels of a sky's picture.
void shrinkTo(uint32_t most, Sky& sky);

/// Returns what a warning calls an image of the scene: its number, and its name where it has one.
std::string imageName(const Scene& scene, int image);
/// Returns what a warning says of a picture of that size which is made smaller, for `taker` takes no more.
std::string tooLarge(uint32_t width, uint32_t height, uint32_t most, const char* taker = "this device");

} // namespace relume
