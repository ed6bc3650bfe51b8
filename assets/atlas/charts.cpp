#include "assets/atlas/charts.h"

#include "assets/atlas/chart_join.h"
#include "assets/atlas/chart_segments.h"
#include "assets/atlas/chart_set.h"
#include "assets/atlas/welded_mesh.h"
#include "assets/base/worker_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace relume {

namespace {

constexpr size_t kTried = 16;          // border edges, the longest, whose direction may be the chart's
constexpr double kAligned = 1e-3;      // sine of the angle to the box, below which an edge runs along it
constexpr double kMostlyAligned = 0.5; // of the border, to turn the chart by it

/// Returns the corners in a box of about 1 m, for which the bounds of all steps are made, and the box's size.
std::vector<glm::dvec3> inUnitBox(const std::vector<glm::dvec3>& corners, double& size) {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const glm::dvec3& p : corners) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) continue;
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const glm::dvec3 extent = high - low;
    size = std::max({extent.x, extent.y, extent.z});
    if (!(size > 0.0) || !std::isfinite(size)) size = 1.0;
    size = std::exp2(std::round(std::log2(size))); // which no coordinate notices
    std::vector<glm::dvec3> scaled(corners.size());
    for (size_t i = 0; i < corners.size(); ++i)
        scaled[i] = corners[i] / size;
    return scaled;
}

/// Returns the direction, of length 1, along or across which most of the border runs; nothing where that is
/// little.
std::optional<glm::dvec2> mainDirection(std::vector<glm::dvec2> edges) {
    double border = 0.0, most = 0.0;
    for (const glm::dvec2& e : edges)
        border += glm::length(e);
    const size_t tried = std::min(kTried, edges.size());
    std::partial_sort(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(tried), edges.end(),
                      [](const glm::dvec2& a, const glm::dvec2& b) {
                          const double lengthA = glm::dot(a, a), lengthB = glm::dot(b, b);
                          if (lengthA != lengthB) return lengthA > lengthB;
                          return a.x != b.x ? a.x < b.x : a.y < b.y;
                      });
    std::optional<glm::dvec2> best;
    for (size_t i = 0; i < tried; ++i) {
        const double length = glm::length(edges[i]);
        if (!(length > 0.0)) continue;
        const glm::dvec2 d = edges[i] / length;
        double aligned = 0.0;
        for (const glm::dvec2& e : edges) {
            const double along = std::abs(glm::dot(d, e)), across = std::abs(d.x * e.y - d.y * e.x);
            if (std::min(along, across) <= kAligned * std::max(along, across)) aligned += glm::length(e);
        }
        if (!(aligned > most)) continue;
        most = aligned;
        best = d;
    }
    return most > kMostlyAligned * border ? best : std::nullopt;
}

/// Turns the points so that the direction is that of the first axis, moves them to the origin and returns
/// their extent.
glm::dvec2 turnAlong(const glm::dvec2& direction, std::vector<glm::dvec2>& points) {
    glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
    for (glm::dvec2& p : points) {
        p = {glm::dot(p, direction), glm::dot(p, glm::dvec2(-direction.y, direction.x))};
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    for (glm::dvec2& p : points)
        p -= low;
    return high - low;
}

PlanarChart finishChart(const FlatChart& chart, const ChartSet& set, double size) {
    PlanarChart out;
    out.triangles = chart.triangles;
    out.uv.reserve(3 * chart.triangles.size());
    std::vector<glm::dvec2> border;
    for (uint32_t t : chart.triangles)
        for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
            out.uv.push_back(size * set.uv[h]);
            if (!set.glued[h]) border.push_back(set.uv[WeldedMesh::nextCorner(h)] - set.uv[h]);
        }
    const std::optional<glm::dvec2> direction = mainDirection(std::move(border));
    out.extent = direction ? turnAlong(*direction, out.uv) : turnToLeastBox(out.uv);
    return out;
}

} // namespace

std::vector<PlanarChart> cutCharts(const std::vector<glm::dvec3>& corners, double texel, WorkerPool& pool) {
    double size = 1.0;
    const WeldedMesh mesh = weld(inUnitBox(corners, size));
    ChartSet set = flattenSegments(mesh, growSegments(mesh), pool);
    joinCharts(mesh, texel / size, pool, set);
    std::erase_if(set.charts, [](const FlatChart& chart) { return chart.triangles.empty(); });
    std::vector<PlanarChart> charts(set.charts.size());
    pool.run(static_cast<uint32_t>(charts.size()),
             [&](uint32_t i) { charts[i] = finishChart(set.charts[i], set, size); });
    return charts;
}

} // namespace relume
