#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/trace/bvh_builder.h"

namespace relume {

/// A tree that follows triangles that move, at the cost of those alone: they leave the tree that was built
/// over all of them, whose boxes shrink to what is left, and get one of their own; node 0 joins both. A ray
/// hits what it would in a tree built anew.
class MovingBvh {
public:
    explicit MovingBvh(const WorldMesh& mesh, WorkerPool* pool = nullptr); // buildBvh()

    /// Returns the tree that the shaders walk. Nodes come before their children, but for the root of the tree
    /// that was built first, once triangles have left it.
    const Bvh& bvh() const { return bvh_; }

    /// The entries of bvh() that have changed, those that were added included, in ascending order.
    struct Change {
        bool all = false; // everything is: the lists are empty
        std::vector<uint32_t> nodes, triangles;
    };
    /// Follows the mesh's triangles of these indices, ascending, which stand elsewhere now. The mesh has as
    /// many as the tree was built with.
    Change follow(const WorldMesh& mesh, std::span<const uint32_t> moved);

private:
    void build(const WorldMesh& mesh, float reach);
    bool wantsAnew(size_t outside, size_t moved) const;
    void findPlaces();
    uint32_t remove(uint32_t triangle, Change& change);
    BvhBox boxOf(int child) const;
    void refit(const std::vector<uint32_t>& leaves, Change& change);
    void join(const WorldMesh& mesh);

    WorkerPool* pool_;
    Bvh bvh_;
    float reach_ = 0, margin_ = 0;   // [m], those that boxes were made for
    uint32_t nodes_ = 0, depth_ = 0; // of the tree of those that have not moved, the joining node not counted
    float area_ = 0;                 // of their triangles [m^2], twice
    std::vector<uint32_t> outside_;  // triangles that have a tree of their own, ascending
    // Once something has moved, these describe the tree of the other triangles: per node its parent and what
    // it holds; per triangle of the mesh the node of its leaf and, in bit 0, which child that is.
    std::vector<uint32_t> parents_, leaves_;
    std::vector<BvhBox> boxes_;
};

} // namespace relume
