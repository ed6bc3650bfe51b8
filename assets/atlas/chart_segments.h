#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "assets/atlas/welded_mesh.h"

namespace relume {

/// Connected triangles that face alike, as a forest: what cannot be flattened in one piece falls into its two
/// parts.
struct SegmentForest {
    std::vector<std::vector<uint32_t>> facets;  // triangles of each leaf, which lie in one plane
    std::vector<std::array<uint32_t, 2>> parts; // of node facets.size() + i: two nodes before it
    std::vector<uint32_t> roots;

    /// Returns all triangles below a node.
    std::vector<uint32_t> trianglesOf(uint32_t node) const;
};

/// Joins the triangles of each plane to facets, and these to segments, by the order of variance of normals
/// per border saved [after Garland et al. 2001 and Cohen-Steiner et al. 2004], as long as the normals of a
/// segment stay within a cone and no crease of 60 degrees runs between. A facet that is large beside its
/// smooth neighbours is a wall and stays alone.
SegmentForest growSegments(const WeldedMesh& mesh);

} // namespace relume
