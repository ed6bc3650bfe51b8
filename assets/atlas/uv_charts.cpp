#include "assets/atlas/uv_charts.h"

#include "assets/base/numbering.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace relume {

namespace {

struct Corner {
    uint32_t bits[5];
    bool operator==(const Corner& other) const { return std::memcmp(bits, other.bits, sizeof(bits)) == 0; }
};

Corner cornerOf(const glm::vec3& p, const glm::vec2& uv) {
    const float values[5] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f, uv.x + 0.0f,
                             uv.y + 0.0f}; // + 0: no negative zeros
    Corner corner;
    std::memcpy(corner.bits, values, sizeof(values));
    return corner;
}

uint64_t hashOf(const Corner& corner) {
    uint64_t h = 0;
    for (uint32_t bits : corner.bits)
        h = mixBits(h ^ (bits + 0x9e3779b97f4a7c15ull));
    return h;
}

uint32_t rootOf(std::vector<uint32_t>& parent, uint32_t i) {
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

bool hasSet(const Primitive& primitive, int set) {
    return uvSet(primitive, set).size() == primitive.positions.size();
}

/// Returns three welded vertices per triangle of all primitives that have the set.
std::vector<uint32_t> weld(const Mesh& mesh, int set) {
    size_t vertices = 0;
    for (const Primitive& primitive : mesh.primitives)
        if (hasSet(primitive, set)) vertices += primitive.positions.size();
    Numbering<Corner> numbering(vertices);
    std::vector<uint32_t> welded, corners;
    for (const Primitive& primitive : mesh.primitives) {
        if (!hasSet(primitive, set)) continue;
        welded.resize(primitive.positions.size());
        for (size_t v = 0; v < welded.size(); ++v) {
            const Corner corner = cornerOf(primitive.positions[v], uvSet(primitive, set)[v]);
            welded[v] = numbering(corner, hashOf(corner));
        }
        for (uint32_t index : primitive.indices)
            corners.push_back(welded[index]);
    }
    return corners;
}

} // namespace

UvCharts findCharts(const Mesh& mesh, int set) {
    const std::vector<uint32_t> corners = weld(mesh, set);
    std::vector<uint32_t> parent(corners.size() / 3);
    std::iota(parent.begin(), parent.end(), 0u);
    Numbering<uint64_t> edges(corners.size());
    std::vector<uint32_t> firstTriangle; // per edge
    for (size_t i = 0; i < corners.size(); ++i) {
        const uint32_t triangle = static_cast<uint32_t>(i / 3);
        const uint32_t a = corners[i], b = corners[i % 3 == 2 ? i - 2 : i + 1];
        if (a == b) continue;
        const uint64_t key = (uint64_t(std::min(a, b)) << 32) | std::max(a, b);
        const uint32_t edge = edges(key, mixBits(key));
        if (edge == firstTriangle.size()) {
            firstTriangle.push_back(triangle);
        } else {
            const uint32_t x = rootOf(parent, triangle), y = rootOf(parent, firstTriangle[edge]);
            parent[std::max(x, y)] = std::min(x, y);
        }
    }
    UvCharts charts;
    std::vector<uint32_t> number(parent.size(), kNoNumber);
    uint32_t triangle = 0;
    for (const Primitive& primitive : mesh.primitives) {
        charts.chart.emplace_back();
        if (!hasSet(primitive, set)) continue;
        for (size_t i = 0; i < primitive.indices.size(); i += 3, ++triangle) {
            uint32_t& chart = number[rootOf(parent, triangle)];
            if (chart == kNoNumber) chart = charts.count++;
            charts.chart.back().push_back(chart);
        }
    }
    return charts;
}

} // namespace relume
