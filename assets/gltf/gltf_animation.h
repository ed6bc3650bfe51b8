#pragma once

#include "assets/gltf/gltf_build.h"
#include "assets/gltf/gltf_node.h"

namespace relume::gltf {

/// Returns the poses of the nodes that the file's first animation moves, at `time` [s]. Before its first key
/// and behind its last one a channel stays as it is there (glTF 2.0, section 3.11). A channel that cannot be
/// read is left out with a warning. Throws Error where the file has no animation.
Poses posesAt(Build& build, double time);

} // namespace relume::gltf
