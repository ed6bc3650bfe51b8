#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/base/shader_types.h"

namespace relume {

/// Fewer than so many: the shaders count bytes in 32 bits.
constexpr uint32_t kMostBvhTriangles = 1u << 26;

/// The tree that shaders/lib/bvh_traverse.glsl walks.
struct Bvh {
    std::vector<shader::BvhNode> nodes;         // depth first, node 0 is the root
    std::vector<shader::BvhTriangle> triangles; // those of a leaf are neighbours
    uint32_t depth = 0;                         // inner nodes on the longest way down, <= shader::kBvhDepth
};

/// [m]; nothing is in it before anything was added.
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
/// The box of a node's child 0 or 1: a little larger than what the child holds, empty where that is nothing.
BvhBox childBox(const shader::BvhNode& node, int child);
/// As that of a child that holds this, with so much [m] around it (bvhMargin).
void setChildBox(shader::BvhNode& node, int child, const BvhBox& box, float margin);

/// What a child of a node holds.
struct BvhContent {
    BvhBox box;
    float area = 0; // of the triangles [m^2], twice
};
/// A node of two children, the one that more likely stops a ray as its child 0.
shader::BvhNode bvhNode(const BvhContent& content0, int child0, const BvhContent& content1, int child1,
                        float margin);

/// The largest coordinate, either way [m].
float bvhReach(const WorldMesh& mesh);
/// What boxes are larger by for rays among coordinates up to `reach` [m].
float bvhMargin(float reach);

/// Binary tree over all triangles by the surface area heuristic, at most 4 triangles to a leaf; masked ones
/// carry bit 31 in their id. The same mesh gives the same tree on any machine. At least one triangle, fewer
/// than kMostBvhTriangles.
Bvh buildBvh(const WorldMesh& mesh);

struct BvhDesc {
    std::span<const uint32_t> triangles; // of the mesh, at least one
    float margin = 0;                    // bvhMargin()
    uint32_t level = 0;                  // nodes above its root
};
/// The same over some triangles; `depth` counts the nodes above, too.
Bvh buildBvh(const WorldMesh& mesh, const BvhDesc& desc);

/// Expected cost of a ray through the root's box: nodes visited plus triangles tested, by the surface area
/// heuristic.
double bvhCost(const Bvh& bvh);

} // namespace relume
