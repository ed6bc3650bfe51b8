#include "assets/atlas/welded_mesh.h"

#include "assets/base/numbering.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relume {

namespace {

constexpr double kThinnestTriangle =
    1e-10;                        // twice the area over the longest edge's square; below it is a line
constexpr size_t kMostSides = 16; // of one edge; where more triangles meet, none continues another

uint64_t weldHash(const glm::dvec3& p) {
    uint64_t h = 0;
    for (int c = 0; c < 3; ++c) {
        uint64_t bits;
        const double value = p[c] + 0.0; // no negative zero
        std::memcpy(&bits, &value, sizeof(bits));
        h = mixBits(h ^ (bits + 0x9e3779b97f4a7c15ull));
    }
    return h;
}

void measureTriangles(WeldedMesh& mesh) {
    const size_t count = mesh.corners.size() / 3;
    mesh.normal.assign(count, glm::dvec3(0.0));
    mesh.area.assign(count, 0.0);
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3* p = &mesh.corners[3 * i];
        const glm::dvec3 a = p[1] - p[0], b = p[2] - p[0], c = p[2] - p[1];
        const double longest = std::sqrt(std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(c, c)}));
        if (!(longest > 0.0) || !std::isfinite(longest)) continue;
        const glm::dvec3 cross = glm::cross(a / longest, b / longest);
        const double shape = glm::length(cross);
        if (!(shape > kThinnestTriangle)) continue;
        mesh.normal[i] = cross / shape;
        mesh.area[i] = 0.5 * shape * longest * longest;
    }
}

/// Pairs the half-edges of one edge, the most even pairs first.
void pairSides(WeldedMesh& mesh, const uint32_t* sides, size_t count) {
    if (count < 2 || count > kMostSides) return;
    for (;;) {
        double best = -2.0;
        uint32_t left = kNoNumber, right = kNoNumber;
        for (size_t i = 0; i < count; ++i) {
            for (size_t k = i + 1; k < count; ++k) {
                const uint32_t a = sides[i], b = sides[k];
                if (mesh.opposite[a] != kNoNumber || mesh.opposite[b] != kNoNumber) continue;
                if (mesh.vertex[a] == mesh.vertex[b])
                    continue; // they run the same way: one of them is turned over
                const double even = glm::dot(mesh.normal[a / 3], mesh.normal[b / 3]);
                if (!(even > best)) continue;
                best = even;
                left = a;
                right = b;
            }
        }
        if (left == kNoNumber) return;
        mesh.opposite[left] = right;
        mesh.opposite[right] = left;
    }
}

void connectSides(WeldedMesh& mesh) {
    const size_t count = mesh.corners.size();
    Numbering<uint64_t> edges(count);
    std::vector<uint32_t> edgeOf(count, kNoNumber);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t a = mesh.vertex[i], b = mesh.vertex[WeldedMesh::nextCorner(i)];
        if (mesh.area[i / 3] == 0.0 || a == b) continue;
        const uint64_t key = (uint64_t(std::min(a, b)) << 32) | std::max(a, b);
        edgeOf[i] = edges(key, mixBits(key));
    }
    std::vector<uint32_t> first(edges.size() + 1), sides(count);
    for (uint32_t edge : edgeOf)
        if (edge != kNoNumber) ++first[edge + 1];
    for (size_t e = 1; e < first.size(); ++e)
        first[e] += first[e - 1];
    std::vector<uint32_t> at(first.begin(), first.end());
    for (uint32_t i = 0; i < count; ++i)
        if (edgeOf[i] != kNoNumber) sides[at[edgeOf[i]]++] = i;
    for (size_t e = 0; e + 1 < first.size(); ++e)
        pairSides(mesh, sides.data() + first[e], first[e + 1] - first[e]);
}

} // namespace

WeldedMesh weld(std::vector<glm::dvec3> corners) {
    WeldedMesh mesh;
    mesh.corners = std::move(corners);
    mesh.corners.resize(mesh.corners.size() / 3 * 3);
    mesh.opposite.assign(mesh.corners.size(), kNoNumber);
    mesh.vertex.resize(mesh.corners.size());
    Numbering<glm::dvec3> points(mesh.corners.size());
    for (size_t i = 0; i < mesh.corners.size(); ++i)
        mesh.vertex[i] = points(mesh.corners[i], weldHash(mesh.corners[i]));
    mesh.vertices = static_cast<uint32_t>(points.size());
    measureTriangles(mesh);
    connectSides(mesh);
    return mesh;
}

} // namespace relume
