#pragma once

#include <string>

namespace relume {

/// Tells whether the normals that libassimp makes or hands on are the ones that a file means. It smooths over
/// all edges where a .3ds or .ase file has no smoothing groups, and takes a .blend file's normals of vertices
/// whether or not its faces are smooth: a box would be shaded like a pillow. An unreadable file means none.
bool meansItsNormals(const std::string& path);

} // namespace relume
