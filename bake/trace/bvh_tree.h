#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "assets/base/worker_pool.h"
#include "bake/base/shader_types.h"

namespace relume {

/// A box [m]; nothing is in it before anything was added.
struct BvhBox {
    glm::vec3 lo{std::numeric_limits<float>::infinity()}, hi{-std::numeric_limits<float>::infinity()};

    void add(const glm::vec3& point) { lo = glm::min(lo, point), hi = glm::max(hi, point); }
    void add(const BvhBox& box) { lo = glm::min(lo, box.lo), hi = glm::max(hi, box.hi); }
    bool empty() const { return lo.x > hi.x; }
    float halfArea() const { // [m^2]
        const glm::vec3 d = hi - lo;
        return d.x >= 0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0.0f;
    }
};

/// What a node or a leaf holds.
struct BvhContent {
    BvhBox box;
    float area = 0; // of the triangles [m^2], twice

    void add(const BvhContent& other) { box.add(other.box), area += other.area; }
};

/// A tree while it is made. Node 0 is the root, and nodes come before their children until some are moved.
struct BvhTree {
    static constexpr int kNone = -1;

    struct Node {
        BvhContent content;
        int parent = kNone;
        int child[2] = {kNone, kNone}; // both, or none of a leaf
        uint32_t first = 0, count = 0; // a leaf's items

        bool leaf() const { return child[0] == kNone; }
    };
    std::vector<Node> nodes;

    /// Returns the other child of a node's parent; the node is not the root.
    int sibling(int node) const {
        const Node& parent = nodes[size_t(nodes[size_t(node)].parent)];
        return parent.child[parent.child[0] == node ? 1 : 0];
    }
    /// Returns the sum over all inner nodes but the root of half their boxes' areas [m^2]: what rays visit
    /// goes by it.
    double innerArea() const;
    /// Returns the inner nodes on the longest way down.
    uint32_t depth() const;
};

/// Moves subtrees to where they enlarge the boxes above them least, so that rays visit fewer nodes
/// [Bittner et al. 2013; many are searched for at a time, Meister and Bittner 2018]. The nodes with the
/// largest boxes are looked at in rounds, which end where they no longer gain. Leaves stay whole. The same
/// tree gives the same on any machine. Without a pool it works on this thread alone.
void reinsert(BvhTree& tree, WorkerPool* pool);

} // namespace relume
