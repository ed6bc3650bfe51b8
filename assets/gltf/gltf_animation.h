#pragma once

#include "assets/gltf/gltf_build.h"
#include "assets/gltf/gltf_node.h"

namespace relume::gltf {

/// Returns the poses of the nodes that the file's first animation moves, at `time` [s]. Before its first key
/// and behind its last one a channel stays as it is there (glTF 2.0, section 3.11). A channel that cannot be
/// read is left out with a warning. Throws Error where the file has no animation.
Poses posesAt(Build& build, double time);

/// Returns the last key's time of the file's first animation [s]; what cannot be read of it does not count.
/// Throws Error where the file has no animation.
double secondsOfAnimation(Build& build);

/// Returns what posesAt() does for each of many times.
std::vector<Poses> posesOver(Build& build, const std::vector<double>& times);

} // namespace relume::gltf
