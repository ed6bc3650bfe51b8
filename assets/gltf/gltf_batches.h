#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "assets/model/scene.h"

namespace relume::gltf {

/// Holds instances of one mesh that a file can tell as one node, by EXT_mesh_gpu_instancing.
struct Batch {
    int mesh = -1;
    std::vector<glm::vec3> translations, scales;
    std::vector<glm::vec4> rotations;        // unit quaternions x, y, z, w
    bool isTurned = false, isScaled = false; // whether any instance is
};

/// From so many instances on a batch is worth its arrays.
constexpr size_t kLeastBatch = 8;

/// Says which instances are saved in batches, and in which.
struct Batches {
    std::vector<Batch> batches;
    std::vector<bool> isBatched; // by Scene::instances
};

/// Collects the instances of meshes that ask for it (Mesh::batched) where there are kLeastBatch at least. An
/// instance that is hidden or sheared, which the extension has no word for, stays a node.
Batches batchesOf(const Scene& scene);

} // namespace relume::gltf
