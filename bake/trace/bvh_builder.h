#pragma once

#include <cstdint>
#include <vector>

#include "assets/world_mesh.h"
#include "bake/shader_types.h"

namespace relume {

/// The tree that shaders/lib/bvh_traverse.glsl walks.
struct Bvh {
    std::vector<shader::BvhNode> nodes;         // depth first, node 0 is the root
    std::vector<shader::BvhTriangle> triangles; // those of a leaf are neighbours
    uint32_t depth = 0;                         // inner nodes on the longest way down, <= shader::kBvhDepth
};

struct BvhBox {
    glm::vec3 lo, hi; // [m]
};
/// The box of a node's child 0 or 1: a little larger than what the child holds.
BvhBox childBox(const shader::BvhNode& node, int child);

/// Binary tree over all triangles by the surface area heuristic, at most 4 triangles to a leaf; masked ones
/// carry bit 31 in their id. The same mesh gives the same tree on any machine. At least one triangle, fewer
/// than 2^26 (the shaders count bytes in 32 bits).
Bvh buildBvh(const WorldMesh& mesh);

/// Expected cost of a ray through the root's box: nodes visited plus triangles tested, by the surface area
/// heuristic.
double bvhCost(const Bvh& bvh);

} // namespace relume
