#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/world_mesh.h"
#include "bake/surface/texture_group.h"

namespace relume {

enum class TexelPart { No, Some, All };

/// A triangle in the lightmap [texels].
struct TexelTriangle {
    std::array<glm::dvec2, 3> corner, edge; // edges from each corner to the next
    std::array<double, 3> least{}; // how far beyond each edge is still there, times the edge's length
    double det = 0;                // twice its area, signed

    /// Tells whether the triangle has a texel or a part of it, or what may be one for all that rounding does.
    TexelPart ofTexel(const glm::dvec2& texel) const {
        TexelPart part = TexelPart::All;
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec2 way = texel - corner[k];
            const double turn = det > 0 ? 1.0 : -1.0;
            const double side = (edge[k].x * way.y - edge[k].y * way.x) * turn;
            const double right = -edge[k].y * turn, up = edge[k].x * turn; // what a texel's edges add
            if (side + std::max(right, 0.0) + std::max(up, 0.0) < 2 * least[k]) return TexelPart::No;
            if (side + std::min(right, 0.0) + std::min(up, 0.0) < 0) part = TexelPart::Some;
        }
        return part;
    }
    /// Returns the weights of corners 1 and 2 there.
    glm::dvec2 weights(const glm::dvec2& at) const {
        const glm::dvec2 a = corner[1] - corner[0], b = corner[2] - corner[0], q = at - corner[0];
        return glm::dvec2(q.x * b.y - q.y * b.x, a.x * q.y - a.y * q.x) / det;
    }
    /// Tells whether a point lies in it, or no farther beyond its edges than rounding does.
    bool has(const glm::dvec2& at) const {
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec2 way = at - corner[k];
            const double side = (edge[k].x * way.y - edge[k].y * way.x) * (det > 0 ? 1.0 : -1.0);
            if (side < least[k]) return false;
        }
        return true;
    }
};

/// Returns one of the mesh's triangles in a lightmap with this edge [texels].
TexelTriangle texelTriangle(const WorldMesh& mesh, uint32_t triangle, uint32_t size);

/// Rows of a lightmap that one thread works on, so that nobody else writes to their texels.
struct TexelRows {
    uint32_t first = 0, last = 0; // of the lightmap
};

constexpr uint32_t kBandRows = 8; // in a band

inline uint32_t bandCount(const TexelWindow& window) {
    return (window.rows + kBandRows - 1) / kBandRows;
}
TexelRows bandRows(const TexelWindow& window, uint32_t band);

/// Returns those of the triangles from `first` to before `end` that may cover texels of each band of the
/// window, ascending; those without a chart are left out.
std::vector<std::vector<uint32_t>> trianglesOfBands(const WorldMesh& mesh, uint32_t first, uint32_t end,
                                                    const TexelWindow& window, uint32_t size);

/// Calls work(texel) for the texels of these rows in a triangle's bounds.
template<class Work>
void overBounds(const TexelTriangle& triangle, const TexelWindow& w, const TexelRows& rows,
                const Work& work) {
    glm::dvec2 lo = triangle.corner[0], hi = lo;
    for (const glm::dvec2& c : triangle.corner) {
        lo = glm::min(lo, c);
        hi = glm::max(hi, c);
    }
    const glm::dvec2 first(w.column, rows.first), last(w.column + w.columns - 1, rows.last);
    const glm::dvec2 from = glm::max(glm::floor(lo), first), to = glm::min(glm::floor(hi), last);
    for (double y = from.y; y <= to.y; ++y)
        for (double x = from.x; x <= to.x; ++x)
            work(glm::uvec2(static_cast<uint32_t>(x), static_cast<uint32_t>(y)));
}

} // namespace relume
