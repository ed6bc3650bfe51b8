#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "assets/base/worker_pool.h"
#include "bake/base/shader_types.h"

namespace relume {

/// A tree has fewer triangles than this: the shaders count bytes in 32 bits.
constexpr uint32_t kMostBvhTriangles = 1u << 26;

/// The tree that shaders/lib/rays/bvh_traverse.glsl walks.
struct Bvh {
    std::vector<shader::BvhNode> nodes;         // depth first, node 0 is the root
    std::vector<shader::BvhTriangle> triangles; // those of a leaf are neighbours
    uint32_t depth = 0;                         // inner nodes on the longest way down, <= shader::kBvhDepth
};

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
/// Returns the box of a node's child 0 or 1: a little larger than what the child holds, empty where that is
/// nothing.
BvhBox childBox(const shader::BvhNode& node, int child);
/// Sets the box of a child that holds `box`, with `margin` [m] around it (bvhMargin).
void setChildBox(shader::BvhNode& node, int child, const BvhBox& box, float margin);

/// The content of a node's child.
struct BvhContent {
    BvhBox box;
    float area = 0; // of the triangles [m^2], twice
};
/// Makes a node of two children; child 0 is the one that more likely stops a ray.
shader::BvhNode bvhNode(const BvhContent& content0, int child0, const BvhContent& content1, int child1,
                        float margin);

/// Returns the largest coordinate, either way [m].
float bvhReach(const WorldMesh& mesh);
/// Returns by how much boxes are larger for rays among coordinates up to `reach` [m].
float bvhMargin(float reach);

/// Builds a binary tree over all triangles by the surface area heuristic, with at most 4 triangles to a leaf;
/// masked ones carry bit 31 in their id. The same mesh gives the same tree on any machine. It must have at
/// least one triangle, and fewer than kMostBvhTriangles. Without a pool it is built on this thread alone.
Bvh buildBvh(const WorldMesh& mesh, WorkerPool* pool = nullptr);

struct BvhDesc {
    std::span<const uint32_t> triangles; // of the mesh, at least one
    float margin = 0;                    // bvhMargin()
    uint32_t level = 0;                  // nodes above its root
    WorkerPool* pool = nullptr;          // to build on; nullptr: on this thread alone
};
/// Builds the same over some triangles; `depth` counts the nodes above, too.
Bvh buildBvh(const WorldMesh& mesh, const BvhDesc& desc);

/// Returns the expected cost of a ray through the root's box: nodes visited plus triangles tested, by the
/// surface area heuristic.
double bvhCost(const Bvh& bvh);

} // namespace relume
