#pragma once

#include <map>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/gltf/gltf_build.h"

namespace relume::gltf {

/// Holds the numbers by which EXT_mesh_gpu_instancing places the copies of a node's mesh. A list is empty
/// where the node has none, or one that does not fit.
struct CopyNumbers {
    std::vector<float> translations, rotations, scales; // 3, 4 (x, y, z, w) and 3 for each copy

    /// Return the number of copies that have all they need, and of those that the longest list has.
    size_t count() const;
    size_t most() const;
};

/// Reads these numbers. Translations and scales are floats, rotations floats or normalized integers. What
/// does not fit is left out with a warning that names `where`. Throws Error.
CopyNumbers copyNumbersOf(Build& build, const nlohmann::json& node, const std::string& where);

/// Returns which copies of a node are hidden, with the scale that they have when they are shown: those of
/// extras.relume.hiddenCopies that are scaled to nothing. Other programs show a copy that is not.
std::map<size_t, glm::vec3> hiddenCopiesOf(const nlohmann::json& node, const CopyNumbers& numbers);

/// A copy that a node makes of its mesh.
struct NodeCopy {
    glm::dmat4 transform{1.0}; // to the node
    bool hidden = false;
};

/// Returns the copies that EXT_mesh_gpu_instancing makes of a node's mesh; none where the node does not use
/// it. Warns as copyNumbersOf() does.
std::vector<NodeCopy> copiesOf(Build& build, const nlohmann::json& node, const std::string& where);

} // namespace relume::gltf
