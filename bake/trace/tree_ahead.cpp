#include "bake/trace/tree_ahead.h"

#include <utility>

namespace relume {

TreeAhead::TreeAhead(const WorldMesh& mesh, WorkerPool& pool) {
    WorldMesh corners; // all of a mesh that a tree is built from
    corners.positions = mesh.positions;
    corners.material.resize(mesh.triangleCount());
    corners.opaqueCount = mesh.opaqueCount;
    tree_ =
        std::async(std::launch::async, [mesh = std::move(corners), &pool] { return MovingBvh(mesh, &pool); });
}

} // namespace relume
