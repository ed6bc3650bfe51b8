#pragma once

#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace relume::gltf {

/// A node's transform to its parent, of a checked file.
glm::dmat4 localTransform(const nlohmann::json& node);

/// The nodes without parent of the default scene, of all nodes where there is no scene. `nodes` and `scenes`
/// are arrays of a checked file.
std::vector<int> rootNodes(const nlohmann::json& nodes, const nlohmann::json& scenes, int defaultScene);

} // namespace relume::gltf
