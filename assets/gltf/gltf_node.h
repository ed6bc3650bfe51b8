#pragma once

#include <functional>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

namespace relume::gltf {

/// Holds what an animation sets of a node.
struct NodePose {
    std::optional<glm::dvec3> translation, scale;
    std::optional<glm::dquat> rotation;
    std::vector<float> weights; // of morph targets; empty: not set
};
/// Holds the poses of those nodes that an animation moves.
using Poses = std::map<size_t, NodePose>;

/// Returns the transform of a node of a checked file to its parent, with `pose` in place of what it sets.
glm::dmat4 localTransform(const nlohmann::json& node, const NodePose* pose = nullptr);

/// Returns the parent of each node, -1 for none. `twice` is called with a node that has two.
std::vector<int> parentsOf(const nlohmann::json& nodes, const std::function<void(size_t)>& twice = {});

/// Returns the nodes at the top of a scene, or those without parent where there is no scene. A node that a
/// scene lists beside one of its ancestors is not at the top. `nodes` and `scenes` are arrays of a checked
/// file.
std::vector<int> rootNodes(const nlohmann::json& nodes, const nlohmann::json& scenes, int scene);

/// Tells where the nodes of a checked file stand.
class NodePlaces {
public:
    NodePlaces(const nlohmann::json& nodes, const Poses& poses); // both must outlive it

    glm::dmat4 local(size_t node) const;
    /// Returns the transform of a node to world, by all its ancestors.
    glm::dmat4 world(size_t node);
    glm::dmat4 parentWorld(size_t node);
    int parent(size_t node) const { return parents_[node]; } // -1: none
    const NodePose* pose(size_t node) const;                 // nullptr: as in the file

private:
    const nlohmann::json& nodes_;
    const Poses& poses_;
    std::vector<int> parents_;
    std::unordered_map<size_t, glm::dmat4> known_; // worlds, looked up alone
};

} // namespace relume::gltf
