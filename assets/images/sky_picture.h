#pragma once

#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Reads the picture that sky.file names, an OpenEXR with R, G and B or a Radiance .hdr of at most 64 Mpixel
/// and 65535 pixels along a side, into sky.width, height and pixels. NaN and negative values become 0,
/// infinite ones the largest finite one of the picture. Returns what was corrected or looks wrong, as one
/// line each about the file. Throws Error.
std::vector<std::string> readSkyPicture(Sky& sky);

/// Reads the picture where the sky has a file and no pixels of it, because an edit took another picture.
void readEditedPicture(Sky& sky);

} // namespace relume
