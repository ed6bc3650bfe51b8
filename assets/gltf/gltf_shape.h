#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/gltf/gltf_build.h"
#include "assets/gltf/gltf_node.h"

namespace relume::gltf {

/// Says how the shape of a mesh is changed before it is placed: by morph targets, and then by the joints of a
/// skin.
struct Shape {
    std::vector<float> weights;     // of morph targets, missing ones are 0
    std::vector<glm::dmat4> joints; // joint space to world, times the inverse bind matrix; empty: no skin

    bool operator==(const Shape&) const = default;
};

/// Says which shapes of a mesh of the file are built.
struct ShapePlan {
    struct Entry {
        size_t mesh; // of the file
        Shape shape;
    };
    /// The first ones are those of the file's meshes, in their order: as most of their nodes have them.
    /// Behind these are those of nodes whose skin or weights are their own.
    std::vector<Entry> entries;
    std::set<size_t> skinned;     // the nodes whose mesh is placed by joints
    std::map<size_t, int> ofNode; // the entry that a node shows where that is not its mesh's own
};

/// Finds the shapes that nodes give their meshes, all of the file's nodes alike. A skin that does not fit is
/// left out with a warning.
ShapePlan planShapes(Build& build, NodePlaces& places);

/// Moves the vertices of a primitive: `joints` and `weights` are four per vertex, one list for each set. A
/// vertex without weight hangs at the first of its joints. Normals get the direction that the vertex's matrix
/// gives their plane. Returns false where a joint is none of the skin's; it then counts nothing.
bool bend(const Shape& shape, const std::vector<std::vector<glm::vec4>>& joints,
          const std::vector<std::vector<glm::vec4>>& weights, Primitive& primitive);

} // namespace relume::gltf
