#pragma once

#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace relume::gltf {

/// Returns the transform of a node of a checked file to its parent.
glm::dmat4 localTransform(const nlohmann::json& node);

/// Returns the nodes without parent of the default scene, or those of all nodes where there is no scene.
/// `nodes` and `scenes` are arrays of a checked file.
std::vector<int> rootNodes(const nlohmann::json& nodes, const nlohmann::json& scenes, int defaultScene);

} // namespace relume::gltf
