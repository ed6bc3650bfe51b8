#pragma once

#include "assets/model/scene.h"

// A pane is a surface that light passes as though it were not there: it stops no ray, receives and sends no
// light, and pictures show what is behind it. It stands for glass and the like, whose tint is not computed.
namespace relume {

/// A material whose mean alpha is below the first of these, in alpha mode BLEND, or which transmits more than
/// the second, lets more light through than it stops.
constexpr float kMostAlpha = 0.5f, kLeastTransmission = 0.5f;

/// Tells whether light passes a material; `textureAlpha` is the mean alpha of its base colour texture, 1
/// where it has none. What shines is no pane, since its light would be lost.
bool passesLight(const Material& material, float textureAlpha);

/// Sets Material::pane of all materials. There is no pane where all that is shown would be one, such as a
/// vase by itself: then there would be nothing to bake.
void markPanes(Scene& scene);

/// Returns the mean of a channel (0 red ... 3 alpha) over an image's pixels, from 0 to 1; 1 without pixels.
double meanOfChannel(const Image& image, size_t channel);

} // namespace relume
