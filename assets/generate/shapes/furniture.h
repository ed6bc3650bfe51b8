#pragma once

#include "assets/generate/shapes/shapes.h"

// These things stand or hang in more than one generated scene. They point up or stand on the ground like all
// shapes.
namespace relume::generate {

/// Objects stand this far inside what they stand on, so that no two faces share a plane [m].
constexpr double kSunk = 0.0121;

/// Makes a globe for lamps in one chart, from pole to pole.
Solid globe(double radius, int segments, int rows);

/// Makes a picture in a frame, its back at y = 0 and its upper edge towards -Z: lay it on a wall. `size` is
/// that of the picture [m].
Solid framedPicture(const glm::dvec2& size, int picture, int frame);

/// Makes a lit rectangle in a collar, facing down from `depth` below the ceiling; the origin is in the
/// ceiling's plane.
Solid ceilingLight(const glm::dvec2& size, double depth, int lit, int collar);

/// Makes a square plinth with foot and cornice, its top at `height`. `halfWidth` is that of the shaft.
Solid plinth(double halfWidth, double height);

} // namespace relume::generate
