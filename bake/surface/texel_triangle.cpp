#include "bake/surface/texel_triangle.h"

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// Charts whose edge is a texel's, too, cover it for all that rounding does [texels].
constexpr double kEdgeRounding = 1e-3;

} // namespace

TexelTriangle texelTriangle(const WorldMesh& mesh, uint32_t triangle, uint32_t size) {
    TexelTriangle result;
    for (size_t k = 0; k < 3; ++k)
        result.corner[k] = glm::dvec2(mesh.lightmapUv[size_t{triangle} * 3 + k]) * double(size);
    for (size_t k = 0; k < 3; ++k) {
        result.edge[k] = result.corner[(k + 1) % 3] - result.corner[k];
        result.least[k] = -kEdgeRounding * glm::length(result.edge[k]);
    }
    const glm::dvec2 a = result.corner[1] - result.corner[0], b = result.corner[2] - result.corner[0];
    result.det = a.x * b.y - a.y * b.x;
    return result;
}

TexelRows bandRows(const TexelWindow& window, uint32_t band) {
    return {window.row + band * kBandRows, window.row + std::min(window.rows, (band + 1) * kBandRows) - 1};
}

std::vector<std::vector<uint32_t>> trianglesOfBands(const WorldMesh& mesh, uint32_t first, uint32_t end,
                                                    const TexelWindow& window, uint32_t size) {
    std::vector<std::vector<uint32_t>> result(bandCount(window));
    for (uint32_t t = first; t < end; ++t) {
        if (mesh.chart[t] == kNoChart) continue;
        const glm::vec2* uv = &mesh.lightmapUv[size_t{t} * 3];
        const double edge = size;
        const double lo = std::floor(std::min({uv[0].y, uv[1].y, uv[2].y}) * edge) - window.row,
                     hi = std::floor(std::max({uv[0].y, uv[1].y, uv[2].y}) * edge) - window.row;
        if (!(hi >= 0) || !(lo < window.rows)) continue;
        const auto from = static_cast<uint32_t>(std::max(lo, 0.0)) / kBandRows,
                   to = static_cast<uint32_t>(std::min(hi, window.rows - 1.0)) / kBandRows;
        for (uint32_t band = from; band <= to; ++band)
            result[band].push_back(t);
    }
    return result;
}

} // namespace relume
