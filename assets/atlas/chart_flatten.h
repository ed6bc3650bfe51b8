#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/atlas/welded_mesh.h"

namespace relume {

/// Triangles that hang together through edges that are glued; a seam within a chart has vertices on either
/// side.
struct ChartPatch {
    std::vector<uint32_t> triangles;
    std::vector<uint32_t> vertex; // 3 per triangle, of the patch
    uint32_t vertices = 0;
};

/// Numbers the patch's vertices. `glued` tells of each half-edge of the mesh whether it is glued to its
/// opposite; `slot` is memory for one number per triangle of the mesh, of which only those of the patch are
/// written.
ChartPatch makePatch(const WeldedMesh& mesh, std::vector<uint32_t> triangles,
                     const std::vector<uint8_t>& glued, std::vector<uint32_t>& slot);

/// Projects the corners of triangles along an axis of length 1; 3 positions per triangle [m].
std::vector<glm::dvec2> projectAlong(const WeldedMesh& mesh, std::span<const uint32_t> triangles,
                                     const glm::dvec3& axis);

/// Moves the patch's vertices so that every triangle becomes as rigid as its neighbours allow, from a first
/// guess [Liu et al. 2008, "A local/global approach to mesh parameterization", as rigid as possible]. `uv`
/// holds a position for each vertex [m]. False, and nothing changed, where the equations have no solution.
bool relaxPatch(const WeldedMesh& mesh, const ChartPatch& patch, std::vector<glm::dvec2>& uv);

} // namespace relume
