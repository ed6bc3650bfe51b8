#pragma once

#include <string>

#include "assets/model/scene.h"

// A sky's picture is a file of its own, which a glTF file names.
namespace relume::gltf {

/// Tells whether the picture is only in memory, so that it needs a file.
bool skyIsHomeless(const Sky& sky);

/// Returns where the sky's picture is, or will be, from the folder of the file at `path`. Throws Error where
/// JSON cannot hold it.
std::string skyPathFrom(const Sky& sky, const std::string& path);

/// Writes the picture as OpenEXR. Throws Error.
void writeSkyPicture(const Sky& sky, const std::string& path);

} // namespace relume::gltf
