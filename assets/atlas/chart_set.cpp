#include "assets/atlas/chart_set.h"

#include "assets/atlas/chart_flatten.h"
#include "assets/atlas/planar_charts.h"
#include "assets/base/numbering.h"
#include "assets/base/worker_pool.h"

#include <cmath>

namespace relume {

namespace {

constexpr double kEdgeOn = 0.05;          // share of a triangle's area that its projection must keep
constexpr double kPlanarStretch = 1.0001; // what a plane has whose triangles differ by less than a degree

/// Tells by the stretch of a projection whether what was projected is a plane.
bool isPlane(const Stretch& stretch) {
    return stretch.normalised() < kPlanarStretch && stretch.flat > stretch.surface / kPlanarStretch;
}

/// Flattens the segments below one root; roots have no triangle in common.
class RootFlattener {
public:
    RootFlattener(const WeldedMesh& mesh, const SegmentForest& forest, const std::vector<uint32_t>& rootOf,
                  std::vector<uint32_t>& nodeOf, std::vector<uint32_t>& slot, ChartSet& set)
        : mesh_(mesh), forest_(forest), rootOf_(rootOf), nodeOf_(nodeOf), slot_(slot), set_(set) {}
    std::vector<FlatChart> run(uint32_t root);

private:
    void setGlue(const std::vector<uint32_t>& triangles, uint32_t node);
    bool flatten(uint32_t node);
    bool relaxed(const std::vector<uint32_t>& triangles, std::vector<glm::dvec2>& uv, Stretch& stretch);
    Stretch measure(const std::vector<uint32_t>& triangles, const std::vector<glm::dvec2>& uv) const;
    void keep(std::vector<uint32_t> triangles, const std::vector<glm::dvec2>& uv, const Stretch& stretch,
              bool plane);
    void cutFacet(uint32_t node);
    void keepPart(const PlanarChart& part, const std::vector<uint32_t>& triangles);

    const WeldedMesh& mesh_;
    const SegmentForest& forest_;
    const std::vector<uint32_t>& rootOf_; // per triangle
    std::vector<uint32_t>& nodeOf_;       // per triangle, of the node that is tried
    std::vector<uint32_t>& slot_;
    ChartSet& set_;
    std::vector<FlatChart> charts_;
};

void RootFlattener::setGlue(const std::vector<uint32_t>& triangles, uint32_t node) {
    for (uint32_t t : triangles)
        nodeOf_[t] = node;
    for (uint32_t t : triangles)
        for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
            const uint32_t other = mesh_.opposite[h];
            set_.glued[h] =
                other != kNoNumber && rootOf_[other / 3] == rootOf_[t] && nodeOf_[other / 3] == node;
        }
}

Stretch RootFlattener::measure(const std::vector<uint32_t>& triangles,
                               const std::vector<glm::dvec2>& uv) const {
    Stretch stretch;
    for (size_t i = 0; i < triangles.size(); ++i)
        stretch.add(&mesh_.corners[3 * size_t(triangles[i])], &uv[3 * i]);
    return stretch;
}

void RootFlattener::keep(std::vector<uint32_t> triangles, const std::vector<glm::dvec2>& uv,
                         const Stretch& stretch, bool plane) {
    FlatChart chart;
    chart.stretch = stretch;
    chart.plane = plane;
    // A texel shall be as large on every chart.
    const double scale = plane ? 1.0 : std::sqrt(stretch.surface / stretch.flat);
    chart.stretch.flat *= scale * scale;
    chart.stretch.squares /= scale * scale;
    for (size_t i = 0; i < uv.size(); ++i)
        set_.uv[3 * size_t(triangles[i / 3]) + i % 3] = scale * uv[i];
    chart.border = borderOf(mesh_, triangles, set_.glued);
    chart.triangles = std::move(triangles);
    charts_.push_back(std::move(chart));
}

/// Relaxes the projected chart; false where that makes it worse than it was.
bool RootFlattener::relaxed(const std::vector<uint32_t>& triangles, std::vector<glm::dvec2>& uv,
                            Stretch& stretch) {
    const ChartPatch patch = makePatch(mesh_, triangles, set_.glued, slot_);
    std::vector<glm::dvec2> positions(patch.vertices);
    for (size_t i = 0; i < uv.size(); ++i)
        positions[patch.vertex[i]] = uv[i];
    if (!relaxPatch(mesh_, patch, positions)) return false;
    std::vector<glm::dvec2> moved(uv.size());
    for (size_t i = 0; i < uv.size(); ++i)
        moved[i] = positions[patch.vertex[i]];
    const Stretch after = measure(triangles, moved);
    if (!(after.normalised() < stretch.normalised()) || chartOverlaps(moved)) return false;
    uv = std::move(moved);
    stretch = after;
    return true;
}

bool RootFlattener::flatten(uint32_t node) {
    std::vector<uint32_t> triangles = forest_.trianglesOf(node);
    glm::dvec3 sum(0.0);
    for (uint32_t t : triangles)
        sum += mesh_.area[t] * mesh_.normal[t];
    const glm::dvec3 axis = glm::normalize(sum);
    for (uint32_t t : triangles)
        if (!(glm::dot(mesh_.normal[t], axis) > kEdgeOn)) return false;
    std::vector<glm::dvec2> uv = projectAlong(mesh_, triangles, axis);
    if (triangles.size() > 2 && chartOverlaps(uv)) return false;
    setGlue(triangles, node);
    Stretch stretch = measure(triangles, uv);
    const bool plane = isPlane(stretch);
    if (!plane) relaxed(triangles, uv, stretch);
    if (!(stretch.normalised() <= kMostStretch)) return false;
    keep(std::move(triangles), uv, stretch, plane);
    return true;
}

void RootFlattener::keepPart(const PlanarChart& part, const std::vector<uint32_t>& triangles) {
    std::vector<uint32_t> own;
    for (uint32_t t : part.triangles)
        own.push_back(triangles[t]);
    const Stretch stretch = measure(own, part.uv);
    if (own.size() > 1 && (!(stretch.normalised() <= kMostStretch) || chartOverlaps(part.uv))) {
        std::vector<glm::dvec3> corners;
        for (uint32_t t : own)
            corners.insert(corners.end(), &mesh_.corners[3 * size_t(t)], &mesh_.corners[3 * size_t(t)] + 3);
        for (const PlanarChart& single : cutSingleTriangles(corners))
            keepPart(single, own);
        return;
    }
    // Numbers of nodes end far below those of triangles counted from the top: each part is a node of its own.
    setGlue(own, kNoNumber - 1 - own.front());
    keep(std::move(own), part.uv, stretch, isPlane(stretch));
}

/// Cuts a plane that covers itself, as a wall does that is there twice.
void RootFlattener::cutFacet(uint32_t node) {
    const std::vector<uint32_t>& triangles = forest_.facets[node];
    std::vector<glm::dvec3> corners;
    for (uint32_t t : triangles)
        corners.insert(corners.end(), &mesh_.corners[3 * size_t(t)], &mesh_.corners[3 * size_t(t)] + 3);
    for (const PlanarChart& part : cutPlanarCharts(corners))
        keepPart(part, triangles);
}

std::vector<FlatChart> RootFlattener::run(uint32_t root) {
    std::vector<uint32_t> open = {root};
    while (!open.empty()) {
        const uint32_t node = open.back();
        open.pop_back();
        if (flatten(node)) continue;
        if (node < forest_.facets.size()) {
            cutFacet(node);
        } else {
            open.push_back(forest_.parts[node - forest_.facets.size()][1]);
            open.push_back(forest_.parts[node - forest_.facets.size()][0]);
        }
    }
    return std::move(charts_);
}

} // namespace

double borderOf(const WeldedMesh& mesh, const std::vector<uint32_t>& triangles,
                const std::vector<uint8_t>& glued) {
    double border = 0.0;
    for (uint32_t t : triangles)
        for (uint32_t h = 3 * t; h < 3 * t + 3; ++h)
            if (!glued[h]) border += glm::distance(mesh.corners[h], mesh.corners[WeldedMesh::nextCorner(h)]);
    return border;
}

ChartSet flattenSegments(const WeldedMesh& mesh, const SegmentForest& forest, WorkerPool& pool) {
    ChartSet set;
    set.uv.resize(mesh.corners.size());
    set.glued.resize(mesh.corners.size());
    const uint32_t roots = static_cast<uint32_t>(forest.roots.size());
    std::vector<uint32_t> rootOf(mesh.triangleCount(), kNoNumber), nodeOf(mesh.triangleCount(), kNoNumber),
        slot(mesh.triangleCount());
    pool.run(roots, [&](uint32_t i) {
        for (uint32_t t : forest.trianglesOf(forest.roots[i]))
            rootOf[t] = i;
    });
    std::vector<std::vector<FlatChart>> found(roots);
    pool.run(roots, [&](uint32_t i) {
        found[i] = RootFlattener(mesh, forest, rootOf, nodeOf, slot, set).run(forest.roots[i]);
    });
    for (std::vector<FlatChart>& charts : found)
        for (FlatChart& chart : charts)
            set.charts.push_back(std::move(chart));
    return set;
}

} // namespace relume
