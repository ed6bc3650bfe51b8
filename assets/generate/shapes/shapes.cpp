#include "assets/generate/shapes/shapes.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>

namespace relume::generate {
namespace {

// Rounds places in a chart to multiples of 2^-20: they follow lengths, which come from the library's sines
// and cosines.
double steadyPlace(double x) {
    constexpr double kSteps = 1048576.0;
    return roundSteadily(x * kSteps) / kSteps;
}

// Holds running sums of the mean distance between neighbouring lines of a grid, starting with 0.
struct Lengths {
    std::vector<double> columns, rows;
};

Lengths measure(const std::vector<glm::dvec3>& points, int columns, int rows) {
    const auto at = [&](int i, int j) { return points[j * (columns + 1) + i]; };
    Lengths lengths{{0.0}, {0.0}};
    for (int i = 0; i < columns; ++i) {
        double sum = 0.0;
        for (int j = 0; j <= rows; ++j)
            sum += glm::distance(at(i, j), at(i + 1, j));
        lengths.columns.push_back(lengths.columns.back() + sum / (rows + 1));
    }
    for (int j = 0; j < rows; ++j) {
        double sum = 0.0;
        for (int i = 0; i <= columns; ++i)
            sum += glm::distance(at(i, j), at(i, j + 1));
        lengths.rows.push_back(lengths.rows.back() + sum / (columns + 1));
    }
    return lengths;
}

std::vector<glm::dvec2> rectangle(double halfX, double halfZ) {
    return {{-halfX, halfZ}, {halfX, halfZ}, {halfX, -halfZ}, {-halfX, -halfZ}};
}

} // namespace

double smooth(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

Solid grid(const GridDesc& desc, const Surface& surface) {
    const int columns = desc.columns, rows = desc.rows;
    std::vector<glm::dvec3> points;
    points.reserve((columns + 1) * (rows + 1));
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double s = desc.closedS && i == columns ? 0.0 : static_cast<double>(i) / columns;
            const double t = desc.closedT && j == rows ? 0.0 : static_cast<double>(j) / rows;
            points.push_back(surface(s, t));
        }
    const Lengths lengths = measure(points, columns, rows);
    Solid solid;
    for (int piece = 0; piece < desc.pieces; ++piece) {
        const int first = columns * piece / desc.pieces, last = columns * (piece + 1) / desc.pieces;
        const double start = lengths.columns[first];
        Chart chart;
        chart.size = {lengths.columns[last] - start, lengths.rows.back()};
        ASSERT(chart.size.x > 0.0 && chart.size.y > 0.0);
        for (int j = 0; j <= rows; ++j)
            for (int i = first; i <= last; ++i) {
                const glm::dvec2 place((lengths.columns[i] - start) / chart.size.x,
                                       lengths.rows[j] / chart.size.y);
                chart.vertices.push_back({points[j * (columns + 1) + i],
                                          {steadyPlace(place.x), steadyPlace(place.y)},
                                          {lengths.columns[i], lengths.rows[j]}});
            }
        const auto wide = static_cast<uint32_t>(last - first + 1);
        for (uint32_t j = 0; j < static_cast<uint32_t>(rows); ++j)
            for (uint32_t i = 0; i + 1 < wide; ++i) {
                const uint32_t a = j * wide + i, b = a + wide;
                chart.indices.insert(chart.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
            }
        solid.charts.push_back(std::move(chart));
    }
    return solid;
}

Solid quad(const glm::dvec3& topLeft, const glm::dvec3& right, const glm::dvec3& down) {
    return panel(topLeft, right, down, {0.0, 1.0}, {0.0, 1.0});
}

Solid panel(const glm::dvec3& topLeft, const glm::dvec3& right, const glm::dvec3& down,
            const std::vector<double>& cutsS, const std::vector<double>& cutsT) {
    const int columns = static_cast<int>(cutsS.size()) - 1, rows = static_cast<int>(cutsT.size()) - 1;
    return grid({.columns = columns, .rows = rows}, [&](double s, double t) {
        return topLeft + right * cutsS[std::lround(s * columns)] + down * cutsT[std::lround(t * rows)];
    });
}

Solid panelWithOpening(const glm::dvec3& topLeft, const glm::dvec3& right, const glm::dvec3& down,
                       const glm::dvec2& from, const glm::dvec2& to) {
    const std::vector<double> cuts = {0.0, from.y, to.y, 1.0};
    const glm::dvec3 middle = topLeft + right * from.x;
    const glm::dvec3 middleRight = right * (to.x - from.x);
    Solid solid = panel(topLeft, right * from.x, down, {0.0, 1.0}, cuts);
    solid.add(quad(middle, middleRight, down * from.y));
    solid.add(quad(middle + down * to.y, middleRight, down * (1.0 - to.y)));
    return solid.add(panel(topLeft + right * to.x, right * (1.0 - to.x), down, {0.0, 1.0}, cuts));
}

Solid polygon(const std::vector<glm::dvec3>& points, const glm::dvec3& right, const glm::dvec3& down) {
    glm::dvec2 low(1e30), high(-1e30);
    for (const glm::dvec3& p : points) {
        const glm::dvec2 flat(glm::dot(p, right), glm::dot(p, down));
        low = glm::min(low, flat);
        high = glm::max(high, flat);
    }
    Chart chart;
    chart.size = high - low;
    for (const glm::dvec3& p : points) {
        const glm::dvec2 flat(glm::dot(p, right), glm::dot(p, down));
        const glm::dvec2 place = (flat - low) / chart.size;
        chart.vertices.push_back({p, {steadyPlace(place.x), steadyPlace(place.y)}, flat - low});
    }
    // A zigzag gives triangles of even size; a fan would give slivers.
    const auto count = static_cast<uint32_t>(points.size());
    uint32_t low0 = 0, high0 = count - 1;
    for (bool fromLow = true; high0 - low0 > 1; fromLow = !fromLow) {
        const uint32_t middle = fromLow ? low0 + 1 : high0 - 1;
        chart.indices.insert(chart.indices.end(), {low0, middle, high0});
        (fromLow ? low0 : high0) = middle;
    }
    Solid solid;
    solid.charts.push_back(std::move(chart));
    return solid;
}

Room room(const glm::dvec3& low, const glm::dvec3& high) {
    const glm::dvec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
    Room out;
    out.floor = quad(low, x, z);
    out.ceiling = quad({low.x, high.y, high.z}, x, -z);
    out.back = quad({low.x, high.y, low.z}, x, -y);
    out.front = quad(high, -x, -y);
    out.left = quad({low.x, high.y, high.z}, -z, -y);
    out.right = quad({high.x, high.y, low.z}, z, -y);
    return out;
}

Solid box(const glm::dvec3& size, Bottom bottom) {
    const glm::dvec3 h(size.x / 2, size.y, size.z / 2);
    const glm::dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    Solid solid = quad({-h.x, h.y, -h.z}, x, z);
    solid.add(quad({-h.x, h.y, h.z}, x, -y));
    solid.add(quad({h.x, h.y, h.z}, -z, -y));
    solid.add(quad({h.x, h.y, -h.z}, -x, -y));
    solid.add(quad({-h.x, h.y, -h.z}, z, -y));
    if (bottom == Bottom::Closed) solid.add(quad({-h.x, 0, h.z}, x, -z));
    return solid;
}

Solid smallBox(const glm::dvec3& size, Bottom bottom) {
    return prism(rectangle(size.x / 2, size.z / 2), size.y, bottom);
}

Solid prism(const std::vector<glm::dvec2>& outline, double height, Bottom bottom) {
    const int corners = static_cast<int>(outline.size());
    Solid solid = grid({.columns = corners, .closedS = true}, [&](double s, double t) {
        const glm::dvec2 p = outline[std::lround(s * corners)];
        return glm::dvec3(p.x, t == 0.0 ? height : 0.0, p.y);
    });
    std::vector<glm::dvec3> top, base;
    for (const glm::dvec2& p : outline) {
        top.emplace_back(p.x, height, p.y);
        base.insert(base.begin(), {p.x, 0.0, p.y});
    }
    solid.add(polygon(top, {1, 0, 0}, {0, 0, 1}));
    if (bottom == Bottom::Closed) solid.add(polygon(base, {1, 0, 0}, {0, 0, -1}));
    return solid;
}

std::vector<glm::dvec2> regularPolygon(int corners, double radius, double phase) {
    std::vector<glm::dvec2> out;
    for (int i = 0; i < corners; ++i) {
        const double angle = kTwoPi * i / corners + glm::radians(phase);
        out.emplace_back(radius * std::sin(angle), radius * std::cos(angle));
    }
    return out;
}

glm::dvec3 revolve(double angle, const glm::dvec2& radiusAndHeight) {
    return {radiusAndHeight.x * std::sin(angle), radiusAndHeight.y, radiusAndHeight.x * std::cos(angle)};
}

Solid lathe(const std::vector<glm::dvec2>& profile, int segments, const LatheMap& map) {
    const int rows = static_cast<int>(profile.size()) - 1;
    return grid({.columns = segments, .rows = rows, .closedS = true},
                [&](double s, double t) { return map(kTwoPi * s, profile[std::lround(t * rows)]); });
}

Solid cap(const glm::dvec2& radiusAndHeight, int segments, bool up, const LatheMap& map) {
    std::vector<glm::dvec3> points;
    for (int i = 0; i < segments; ++i) {
        const double s = static_cast<double>(up ? i : segments - 1 - i) / segments;
        points.push_back(map(kTwoPi * s, radiusAndHeight));
    }
    return polygon(points, {1, 0, 0}, {0, 0, up ? 1 : -1});
}

Solid moulding(const glm::dvec2& halfSize, const std::vector<glm::dvec2>& profile) {
    const int rows = static_cast<int>(profile.size()) - 1;
    const std::vector<glm::dvec2> corners = rectangle(1.0, 1.0);
    return grid({.columns = 4, .rows = rows, .closedS = true}, [&](double s, double t) {
        const glm::dvec2 corner = corners[std::lround(s * 4)];
        const glm::dvec2 point = profile[std::lround(t * rows)];
        return glm::dvec3(corner.x * (halfSize.x + point.x), point.y, corner.y * (halfSize.y + point.x));
    });
}

Solid ball(int n, const std::function<glm::dvec3(const glm::dvec3& direction)>& surface) {
    const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const std::array<std::array<glm::dvec3, 3>, 6> faces = {
        {{z, x, -y}, {-z, -x, -y}, {x, -z, -y}, {-x, z, -y}, {y, x, z}, {-y, x, -z}}};
    // Equal angles instead of equal steps on the cube give quads of nearly one size.
    const auto warp = [](double a) {
        return std::abs(a) == 1.0 ? a : std::tan(a * glm::quarter_pi<double>());
    };
    Solid solid;
    for (const std::array<glm::dvec3, 3>& face : faces) // its normal, to the right, downwards
        solid.add(grid({.columns = n, .rows = n}, [&](double s, double t) {
            return surface(glm::normalize(face[0] + warp(2 * s - 1) * face[1] + warp(2 * t - 1) * face[2]));
        }));
    return solid;
}

Solid sphere(double radius, int n) {
    return ball(n, [&](const glm::dvec3& direction) { return radius * direction; });
}

Solid torus(double radius, double tubeRadius, int segments, int tubeSegments) {
    return grid({.columns = segments, .rows = tubeSegments, .closedS = true, .closedT = true}, [&](double s,
                                                                                                   double t) {
        const double around = kTwoPi * t;
        return revolve(kTwoPi * s, {radius + tubeRadius * std::sin(around), tubeRadius * std::cos(around)});
    });
}

glm::dmat3 layOnWall() {
    return glm::dmat3({1, 0, 0}, {0, 0, 1}, {0, -1, 0});
}

std::vector<glm::dvec2> arc(const glm::dvec2& centre, double radius, double fromDegrees, double toDegrees,
                            int steps) {
    std::vector<glm::dvec2> out;
    for (int i = 0; i <= steps; ++i) {
        const double angle = glm::radians(fromDegrees + (toDegrees - fromDegrees) * i / steps);
        out.push_back(centre + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
    }
    return out;
}

} // namespace relume::generate
