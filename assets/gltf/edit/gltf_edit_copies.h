#pragma once

#include <string>

#include "assets/gltf/edit/gltf_edit_node.h"
#include "assets/model/scene.h"

namespace relume::gltf {

/// Writes where the copies that nodes make of their meshes by EXT_mesh_gpu_instancing stand, and which of
/// them are hidden, where that differs. What changes of places, rotations and scales becomes an accessor of
/// floats in a buffer of its own, which lies in the JSON; numbers of other copies stay to the bit. A copy
/// that is hidden alone is scaled to nothing, and its scale is kept in extras.relume.hiddenCopies. Call it
/// before anything leaves its node. Throws Error naming `target`.
void editCopies(FileEdit& edit, const NodeTree& tree, const Scene& before, const Scene& after,
                const std::string& target);

} // namespace relume::gltf
