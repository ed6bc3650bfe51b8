#include "assets/atlas/planar_charts.h"

#include "assets/atlas/uv_grid.h"
#include "assets/base/numbering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace relume {

namespace {

constexpr double kCosCone = 0.70710678; // 45 degrees: projection shrinks lengths by at most 1.41
constexpr double kMinShape = 1e-10;     // twice the area over the longest edge's square; below it is a line
constexpr uint32_t kChartCells = 256;   // least cells to a side of the grid that looks for overlap
constexpr double kSlack = 1e-3;         // of a chart's cells: slivers turn over when snapped to the grid
constexpr size_t kMaxTurns = 256;       // hull edges tried for the box of least area

struct Triangle {
    glm::dvec3 normal{0.0};                                           // unit
    double area = 0.0;                                                // [m^2], 0: no area
    std::array<uint32_t, 3> next = {kNoNumber, kNoNumber, kNoNumber}; // across each edge
};

uint64_t hashOf(const glm::dvec3& p) {
    uint64_t h = 0;
    for (int c = 0; c < 3; ++c) {
        uint64_t bits;
        const double value = p[c] + 0.0; // no negative zero
        std::memcpy(&bits, &value, sizeof(bits));
        h = mixBits(h ^ (bits + 0x9e3779b97f4a7c15ull));
    }
    return h;
}

std::vector<Triangle> shapes(const std::vector<glm::dvec3>& corners) {
    std::vector<Triangle> triangles(corners.size() / 3);
    for (size_t i = 0; i < triangles.size(); ++i) {
        const glm::dvec3* p = &corners[3 * i];
        const glm::dvec3 a = p[1] - p[0], b = p[2] - p[0], c = p[2] - p[1];
        const double longest = std::sqrt(std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)}));
        if (!(longest > 0.0) || !std::isfinite(longest)) continue;
        const glm::dvec3 cross = glm::cross(a / longest, b / longest);
        const double shape = glm::length(cross);
        if (!(shape > kMinShape)) continue;
        triangles[i].normal = cross / shape;
        triangles[i].area = 0.5 * shape * longest * longest;
    }
    return triangles;
}

/// Links triangles across edges that exactly two of them share.
void connect(const std::vector<glm::dvec3>& corners, std::vector<Triangle>& triangles) {
    Numbering<glm::dvec3> points(corners.size());
    std::vector<uint32_t> welded(corners.size());
    for (size_t i = 0; i < corners.size(); ++i)
        welded[i] = points(corners[i], hashOf(corners[i]));
    Numbering<uint64_t> edges(corners.size());
    struct Sides {
        std::array<uint32_t, 2> corner = {kNoNumber, kNoNumber};
        uint32_t count = 0;
    };
    std::vector<Sides> sides;
    for (uint32_t i = 0; i < corners.size(); ++i) {
        const uint32_t a = welded[i], b = welded[i % 3 == 2 ? i - 2 : i + 1];
        if (triangles[i / 3].area == 0.0 || a == b) continue;
        const uint64_t key = (uint64_t(std::min(a, b)) << 32) | std::max(a, b);
        const uint32_t edge = edges(key, mixBits(key));
        if (edge == sides.size()) sides.emplace_back();
        if (sides[edge].count < 2) sides[edge].corner[sides[edge].count] = i;
        ++sides[edge].count;
    }
    for (const Sides& side : sides) {
        if (side.count != 2) continue;
        for (int k = 0; k < 2; ++k)
            triangles[side.corner[k] / 3].next[side.corner[k] % 3] = side.corner[1 - k] / 3;
    }
}

/// Grows charts one after the other.
class Cutter {
public:
    explicit Cutter(const std::vector<glm::dvec3>& corners)
        : corners_(corners), triangles_(shapes(corners)), taken_(triangles_.size()),
          visited_(triangles_.size()) {
        connect(corners_, triangles_);
    }
    std::vector<PlanarChart> run();

private:
    std::vector<uint32_t> grow(uint32_t seed, UvGrid* grid);
    std::array<glm::dvec2, 3> project(uint32_t triangle) const;
    bool overlaps(const std::vector<uint32_t>& chart, glm::dvec2& low, glm::dvec2& high,
                  uint32_t& cells) const;
    PlanarChart finish(std::vector<uint32_t> chart) const;

    const std::vector<glm::dvec3>& corners_;
    std::vector<Triangle> triangles_;
    std::vector<bool> taken_;
    std::vector<uint32_t> visited_; // number of the growth that saw it last
    uint32_t growth_ = 0;
    glm::dvec3 axis_{0.0}, u_{0.0}, v_{0.0}; // of the chart being grown
};

std::array<glm::dvec2, 3> Cutter::project(uint32_t triangle) const {
    std::array<glm::dvec2, 3> uv;
    for (size_t k = 0; k < 3; ++k) {
        const glm::dvec3& p = corners_[3 * triangle + k];
        uv[k] = {glm::dot(p, u_), glm::dot(p, v_)};
    }
    return uv;
}

/// Returns the connected triangles around the seed that face along the axis; with a grid, only those that
/// find free cells.
std::vector<uint32_t> Cutter::grow(uint32_t seed, UvGrid* grid) {
    std::vector<uint32_t> chart = {seed};
    visited_[seed] = ++growth_;
    if (grid) {
        const auto uv = project(seed);
        grid->add(uv[0], uv[1], uv[2]);
    }
    for (size_t i = 0; i < chart.size(); ++i) {
        for (uint32_t next : triangles_[chart[i]].next) {
            if (next == kNoNumber || taken_[next] || visited_[next] == growth_) continue;
            visited_[next] = growth_;
            if (glm::dot(triangles_[next].normal, axis_) < kCosCone) continue;
            const auto uv = project(next);
            if (grid && !grid->addIfFree(uv[0], uv[1], uv[2])) continue;
            chart.push_back(next);
        }
    }
    return chart;
}

/// Tells whether the projected chart covers itself; also gives its bounds and the grid size that found it.
bool Cutter::overlaps(const std::vector<uint32_t>& chart, glm::dvec2& low, glm::dvec2& high,
                      uint32_t& cells) const {
    low = glm::dvec2(std::numeric_limits<double>::max());
    high = -low;
    for (uint32_t triangle : chart) {
        for (const glm::dvec2& p : project(triangle)) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    }
    if (chart.size() < 3) return false; // two triangles on either side of one edge
    cells = std::max(kChartCells, UvGrid::sizeFor(chart.size()));
    UvGrid grid(cells, low, high);
    for (uint32_t triangle : chart) {
        const auto uv = project(triangle);
        grid.add(uv[0], uv[1], uv[2]);
    }
    return static_cast<double>(grid.overlapped()) > kSlack * static_cast<double>(grid.covered());
}

std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> points) { // monotone chain [Andrew 1979]
    std::sort(points.begin(), points.end(), [](const glm::dvec2& a, const glm::dvec2& b) {
        return a.x < b.x || (a.x == b.x && a.y < b.y);
    });
    std::vector<glm::dvec2> hull;
    for (int side = 0; side < 2; ++side) {
        const size_t base = hull.size();
        for (const glm::dvec2& p : points) {
            while (hull.size() >= base + 2) {
                const glm::dvec2 a = hull[hull.size() - 1] - hull[hull.size() - 2],
                                 b = p - hull[hull.size() - 2];
                if (a.x * b.y - a.y * b.x > 0.0) break;
                hull.pop_back();
            }
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

PlanarChart Cutter::finish(std::vector<uint32_t> chart) const {
    PlanarChart out;
    for (uint32_t triangle : chart)
        for (const glm::dvec2& p : project(triangle))
            out.uv.push_back(p);
    out.triangles = std::move(chart);
    out.extent = turnToLeastBox(out.uv);
    return out;
}

std::vector<PlanarChart> Cutter::run() {
    std::vector<uint32_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [this](uint32_t a, uint32_t b) { return triangles_[a].area > triangles_[b].area; });
    std::vector<PlanarChart> charts;
    for (uint32_t seed : order) {
        if (taken_[seed] || triangles_[seed].area == 0.0) continue;
        axis_ = triangles_[seed].normal;
        const glm::dvec3 helper = std::abs(axis_.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        u_ = glm::normalize(glm::cross(helper, axis_));
        v_ = glm::cross(axis_, u_);
        std::vector<uint32_t> chart = grow(seed, nullptr);
        glm::dvec2 low, high;
        uint32_t cells = 0;
        if (overlaps(chart, low, high, cells)) {
            UvGrid grid(cells, low, high);
            chart = grow(seed, &grid);
        }
        for (uint32_t triangle : chart)
            taken_[triangle] = true;
        charts.push_back(finish(std::move(chart)));
    }
    return charts;
}

} // namespace

glm::dvec2 turnToLeastBox(std::vector<glm::dvec2>& points) {
    const std::vector<glm::dvec2> hull = convexHull(points);
    const size_t step = 1 + hull.size() / kMaxTurns;
    double least = std::numeric_limits<double>::max();
    glm::dvec2 direction(1.0, 0.0), corner(0.0), extent(0.0);
    for (size_t i = 0; i < hull.size(); i += step) {
        const glm::dvec2 edge = hull[(i + 1) % hull.size()] - hull[i];
        const double length = glm::length(edge);
        if (!(length > 0.0)) continue;
        const glm::dvec2 d = edge / length;
        glm::dvec2 low(std::numeric_limits<double>::max()), high = -low;
        for (const glm::dvec2& p : hull) {
            const glm::dvec2 q(glm::dot(p, d), glm::dot(p, glm::dvec2(-d.y, d.x)));
            low = glm::min(low, q);
            high = glm::max(high, q);
        }
        const double area = (high.x - low.x) * (high.y - low.y);
        if (!(area < least)) continue;
        least = area;
        direction = d;
        corner = low;
        extent = high - low;
    }
    for (glm::dvec2& p : points)
        p = glm::dvec2(glm::dot(p, direction), glm::dot(p, glm::dvec2(-direction.y, direction.x))) - corner;
    return extent;
}

std::vector<PlanarChart> cutPlanarCharts(const std::vector<glm::dvec3>& corners) {
    return Cutter(corners).run();
}

std::vector<PlanarChart> cutSingleTriangles(const std::vector<glm::dvec3>& corners) {
    std::vector<PlanarChart> charts;
    for (uint32_t i = 0; 3 * i < corners.size(); ++i) {
        const std::vector<glm::dvec3> own(corners.begin() + 3 * i, corners.begin() + 3 * i + 3);
        for (PlanarChart& chart : cutPlanarCharts(own)) {
            chart.triangles = {i};
            charts.push_back(std::move(chart));
        }
    }
    return charts;
}

} // namespace relume
