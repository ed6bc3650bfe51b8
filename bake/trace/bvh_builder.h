#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "assets/base/worker_pool.h"
#include "bake/base/shader_types.h"
#include "bake/trace/bvh_tree.h"

namespace relume {

/// A tree has fewer triangles than this: the shaders count bytes in 32 bits.
constexpr uint32_t kMostBvhTriangles = 1u << 26;

/// The tree that shaders/lib/rays/bvh_traverse.glsl walks.
struct Bvh {
    std::vector<shader::BvhNode> nodes;         // depth first, node 0 is the root
    std::vector<shader::BvhTriangle> triangles; // those of a leaf are neighbours
    uint32_t depth = 0;                         // inner nodes on the longest way down, <= shader::kBvhDepth
};

/// Returns the box of a node's child 0 or 1: a little larger than what the child holds, empty where that is
/// nothing.
BvhBox childBox(const shader::BvhNode& node, int child);
/// Sets the box of a child that holds `box`, with `margin` [m] around it (bvhMargin).
void setChildBox(shader::BvhNode& node, int child, const BvhBox& box, float margin);

/// Makes a node of two children; child 0 is the one that more likely stops a ray.
shader::BvhNode bvhNode(const BvhContent& content0, int child0, const BvhContent& content1, int child1,
                        float margin);

/// Returns the largest coordinate, either way [m].
float bvhReach(const WorldMesh& mesh);
/// Returns by how much boxes are larger for rays among coordinates up to `reach` [m].
float bvhMargin(float reach);

/// Builds a binary tree over all triangles by the surface area heuristic, with at most 4 triangles to a leaf,
/// and moves its subtrees to better places (reinsert()); masked triangles carry bit 31 in their id. The same
/// mesh gives the same tree on any machine. It must have at least one triangle, and fewer than
/// kMostBvhTriangles. Without a pool it is built on this thread alone.
Bvh buildBvh(const WorldMesh& mesh, WorkerPool* pool = nullptr);

struct BvhDesc {
    std::span<const uint32_t> triangles; // of the mesh, at least one
    float margin = 0;                    // bvhMargin()
    uint32_t level = 0;                  // nodes above its root
    WorkerPool* pool = nullptr;          // to build on; nullptr: on this thread alone
    bool reinsert = true;                // takes half as long again, which a tree of few rays is not worth
};
/// Builds the same over some triangles; `depth` counts the nodes above, too.
Bvh buildBvh(const WorldMesh& mesh, const BvhDesc& desc);

/// Returns the expected cost of a ray through the root's box: nodes visited plus triangles tested, by the
/// surface area heuristic.
double bvhCost(const Bvh& bvh);

} // namespace relume
