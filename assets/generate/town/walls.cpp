#include "assets/generate/town/walls.h"

#include <algorithm>
#include <cmath>

namespace relume::generate {
namespace {

std::vector<double> cutsOf(std::vector<double> cuts) {
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
    return cuts;
}

bool isOpen(const std::vector<Opening>& openings, const glm::dvec2& p) {
    return std::any_of(openings.begin(), openings.end(), [&](const Opening& o) {
        return p.x > o.low.x && p.x < o.high.x && p.y > o.low.y && p.y < o.high.y;
    });
}

// Holds the lower edge of a wall on arches: x and height of each corner.
std::vector<glm::dvec2> edgeOf(const ArchesDesc& desc) {
    const double bay = (desc.to - desc.from) / desc.bays, radius = (bay - desc.pier) / 2.0;
    std::vector<glm::dvec2> edge = {{desc.from, desc.springing}};
    for (int i = 0; i < desc.bays; ++i) {
        const double middle = desc.from + bay * (i + 0.5);
        for (int k = 0; k <= desc.steps; ++k) {
            const double angle = kPi * k / desc.steps;
            const double rise = k == 0 || k == desc.steps ? 0.0 : radius * std::sin(angle);
            edge.emplace_back(middle - radius * std::cos(angle), desc.springing + rise);
        }
    }
    edge.emplace_back(desc.to, desc.springing);
    return edge;
}

glm::dvec3 normalOf(const Chart& chart) {
    glm::dvec3 sum(0.0);
    for (size_t i = 0; i + 2 < chart.indices.size(); i += 3) {
        const glm::dvec3& a = chart.vertices[chart.indices[i]].position;
        sum += glm::cross(chart.vertices[chart.indices[i + 1]].position - a,
                          chart.vertices[chart.indices[i + 2]].position - a);
    }
    return sum;
}

} // namespace

glm::dvec3 Frame::point(const glm::dvec3& p) const {
    const int turned = ((quarter % 4) + 4) % 4;
    const glm::dvec3 q = turned == 0   ? p
                         : turned == 1 ? glm::dvec3(p.z, p.y, -p.x)
                         : turned == 2 ? glm::dvec3(-p.x, p.y, -p.z)
                                       : glm::dvec3(-p.z, p.y, p.x);
    return origin + q;
}

Solid Frame::put(Solid solid) const {
    for (Chart& chart : solid.charts)
        for (ChartVertex& vertex : chart.vertices)
            vertex.position = point(vertex.position);
    return solid;
}

Solid wall(const glm::dvec2& low, const glm::dvec2& high, const std::vector<Opening>& openings) {
    std::vector<double> xs = {low.x, high.x}, ys = {low.y, high.y};
    for (const Opening& o : openings) {
        xs.insert(xs.end(), {o.low.x, o.high.x});
        ys.insert(ys.end(), {std::max(o.low.y, low.y), o.high.y});
    }
    xs = cutsOf(xs);
    ys = cutsOf(ys);
    Chart chart;
    chart.size = high - low;
    for (double y : ys)
        for (double x : xs)
            chart.vertices.push_back({{x, y, 0.0}, {0.0, 0.0}, {x, -y}});
    const auto wide = static_cast<uint32_t>(xs.size());
    for (uint32_t j = 0; j + 1 < ys.size(); ++j)
        for (uint32_t i = 0; i + 1 < wide; ++i) {
            if (isOpen(openings, {(xs[i] + xs[i + 1]) / 2.0, (ys[j] + ys[j + 1]) / 2.0})) continue;
            const uint32_t a = j * wide + i, b = a + wide;
            chart.indices.insert(chart.indices.end(), {a, a + 1, b + 1, a, b + 1, b});
        }
    Solid solid;
    solid.charts.push_back(std::move(chart));
    return solid;
}

Solid reveal(const Opening& o, double front, double back) {
    const glm::dvec3 deep(0.0, 0.0, back - front), up(0.0, o.high.y - o.low.y, 0.0),
        along(o.high.x - o.low.x, 0.0, 0.0);
    Solid solid = quad({o.low.x, o.high.y, front}, deep, -up);
    solid.add(quad({o.high.x, o.high.y, back}, -deep, -up));
    solid.add(quad({o.low.x, o.low.y, back}, along, -deep));
    return solid.add(quad({o.low.x, o.high.y, front}, along, deep));
}

Solid strip(double from, double to, const std::vector<glm::dvec2>& profile) {
    const int rows = static_cast<int>(profile.size()) - 1;
    Solid solid = grid({.columns = 1, .rows = rows}, [&](double s, double t) {
        const glm::dvec2& p = profile[std::lround(t * rows)];
        return glm::dvec3(from + (to - from) * s, p.y, p.x);
    });
    for (bool isRight : {false, true})
        solid.add(grid({.columns = 1, .rows = rows}, [&](double s, double t) {
            const glm::dvec2& p = profile[std::lround(t * rows)];
            const bool isWall = isRight ? s == 1.0 : s == 0.0;
            return glm::dvec3(isRight ? to : from, p.y, isWall ? 0.0 : p.x);
        }));
    return solid;
}

Solid arches(const ArchesDesc& desc) {
    const std::vector<glm::dvec2> edge = edgeOf(desc);
    const int columns = static_cast<int>(edge.size()) - 1;
    const double back = -desc.thickness;
    Solid solid = grid({.columns = columns}, [&](double s, double t) {
        const glm::dvec2& p = edge[std::lround(s * columns)];
        return glm::dvec3(p.x, t == 0.0 ? desc.top : p.y, 0.0);
    });
    solid.add(grid({.columns = columns}, [&](double s, double t) {
        const glm::dvec2& p = edge[columns - std::lround(s * columns)];
        return glm::dvec3(p.x, t == 0.0 ? desc.top : p.y, back);
    }));
    for (Chart& chart : solid.charts)
        for (ChartVertex& vertex : chart.vertices)
            vertex.texCoord = {vertex.position.x, -vertex.position.y};
    return solid.add(grid({.columns = columns}, [&](double s, double t) {
        const glm::dvec2& p = edge[std::lround(s * columns)];
        return glm::dvec3(p.x, p.y, t == 0.0 ? 0.0 : back);
    }));
}

Solid archBands(const ArchesDesc& desc) {
    const double bay = (desc.to - desc.from) / desc.bays, radius = (bay - desc.pier) / 2.0;
    // Radius beyond the arch's own, and distance from the wall.
    const std::vector<glm::dvec2> profile = {{0.24, -0.009}, {0.24, 0.047},  {0.205, 0.061}, {0.18, 0.043},
                                             {0.06, 0.047},  {0.031, 0.031}, {0.013, -0.009}};
    const int rows = static_cast<int>(profile.size()) - 1;
    Solid solid;
    for (int i = 0; i < desc.bays; ++i) {
        const double middle = desc.from + bay * (i + 0.5);
        solid.add(grid({.columns = desc.steps, .rows = rows}, [&](double s, double t) {
            const glm::dvec2& p = profile[std::lround(t * rows)];
            const double angle = kPi * s, r = radius + p.x;
            const double rise = s == 0.0 || s == 1.0 ? -0.013 : r * std::sin(angle);
            return glm::dvec3(middle - r * std::cos(angle), desc.springing + rise, p.y);
        }));
    }
    return solid;
}

Solid block(const glm::dvec3& low, const glm::dvec3& high) {
    const glm::dvec3 size = high - low;
    return mapped(box(size, Bottom::Closed).move({low.x + size.x / 2.0, low.y, low.z + size.z / 2.0}));
}

Solid mapped(Solid solid) {
    for (Chart& chart : solid.charts) {
        const glm::dvec3 n = glm::abs(normalOf(chart));
        for (ChartVertex& vertex : chart.vertices) {
            const glm::dvec3& p = vertex.position;
            if (n.y >= n.x && n.y >= n.z)
                vertex.texCoord = {p.x, p.z};
            else
                vertex.texCoord = n.x > n.z ? glm::dvec2(p.z, -p.y) : glm::dvec2(p.x, -p.y);
        }
    }
    return solid;
}

} // namespace relume::generate
