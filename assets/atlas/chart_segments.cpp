#include "assets/atlas/chart_segments.h"

#include "assets/base/numbering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace relume {

namespace {

constexpr double kSamePlane = 0.99996; // cosine of 0.5 degrees: bakes see no difference
constexpr double kPlaneDepth = 1e-4;   // of the seed's longest side: as far as a corner may leave its plane
constexpr double kSmoothCosine = 0.77; // 40 degrees: what bends less is a curved surface
constexpr double kCreaseCosine = 0.5;  // 60 degrees: what bends more is an edge that light does not cross
constexpr double kWall = 4.0;          // times the area of each smooth neighbour
constexpr double kMostVariance =
    0.40; // of a segment's normals; a cap of 60 degrees has 0.44, a half cylinder 0.59
constexpr size_t kMostTriangles = 16384; // of a bent segment: equations of more take long to solve
constexpr double kFlatVariance = 0.02;   // of normals; below it none leaves the cone
constexpr double kConeCosine = 0.26;     // 75 degrees: beyond it a projection is too narrow to start from

/// Holds a neighbour of a segment.
struct Neighbour {
    uint32_t segment;
    double length; // of the common border [m]
    double smooth; // of its part that is no crease [m]
    bool refused;  // the two face too unlike to be joined, and more so when they have grown
};

struct Segment {
    double area = 0.0;
    glm::dvec3 sum{0.0}; // of area times normal
    size_t triangles = 0;
    uint32_t node = 0;
    uint32_t first = 0, last = 0; // of the list of its facets
    std::vector<Neighbour> neighbours;
};

std::vector<uint32_t> byArea(const WeldedMesh& mesh) {
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < mesh.triangleCount(); ++i)
        if (mesh.area[i] > 0.0) order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return mesh.area[a] > mesh.area[b]; });
    return order;
}

/// Joins triangles that lie in the plane of the largest of them.
class FacetGrower {
public:
    explicit FacetGrower(const WeldedMesh& mesh) : mesh_(mesh), facetOf_(mesh.triangleCount(), kNoNumber) {}
    void run(std::vector<std::vector<uint32_t>>& facets) {
        for (uint32_t seed : byArea(mesh_)) {
            if (facetOf_[seed] != kNoNumber) continue;
            const uint32_t number = static_cast<uint32_t>(facets.size());
            facets.push_back(grow(seed, number));
        }
    }
    const std::vector<uint32_t>& facetOf() const { return facetOf_; }

private:
    std::vector<uint32_t> grow(uint32_t seed, uint32_t number) {
        const glm::dvec3* p = &mesh_.corners[3 * size_t(seed)];
        const double longest =
            std::sqrt(std::max({glm::dot(p[1] - p[0], p[1] - p[0]), glm::dot(p[2] - p[0], p[2] - p[0]),
                                glm::dot(p[2] - p[1], p[2] - p[1])}));
        const glm::dvec3 normal = mesh_.normal[seed];
        const double offset = glm::dot(normal, p[0]), depth = kPlaneDepth * longest;
        std::vector<uint32_t> facet = {seed};
        facetOf_[seed] = number;
        for (size_t i = 0; i < facet.size(); ++i) {
            for (uint32_t k = 0; k < 3; ++k) {
                const uint32_t other = mesh_.opposite[3 * facet[i] + k];
                if (other == kNoNumber || facetOf_[other / 3] != kNoNumber) continue;
                if (glm::dot(mesh_.normal[other / 3], normal) < kSamePlane) continue;
                const glm::dvec3& apex = mesh_.corners[WeldedMesh::previousCorner(other)];
                if (std::abs(glm::dot(normal, apex) - offset) > depth) continue;
                facetOf_[other / 3] = number;
                facet.push_back(other / 3);
            }
        }
        return facet;
    }

    const WeldedMesh& mesh_;
    std::vector<uint32_t> facetOf_;
};

class SegmentGrower {
public:
    SegmentGrower(const WeldedMesh& mesh, SegmentForest& forest) : mesh_(mesh), forest_(forest) {}
    void run();

private:
    void gather(const std::vector<uint32_t>& facetOf);
    void findWalls();
    uint32_t find(uint32_t segment);
    void resolve(uint32_t segment);
    double costOf(uint32_t a, const Neighbour& neighbour) const;
    uint32_t cheapest(uint32_t segment);
    void refuse(uint32_t a, uint32_t b);
    void round();
    bool inCone(uint32_t segment, const glm::dvec3& axis) const;
    bool allowed(uint32_t a, uint32_t b) const;
    void join(uint32_t a, uint32_t b);

    const WeldedMesh& mesh_;
    SegmentForest& forest_;
    std::vector<Segment> segments_;
    std::vector<glm::dvec3> normals_; // of facets
    std::vector<uint32_t> parent_, nextFacet_;
    std::vector<uint8_t> wall_;
    std::vector<uint32_t> choice_;  // per segment: the neighbour that it costs least to join, kNoNumber: none
    std::vector<uint32_t> changed_; // segments whose choice may be another now
    std::vector<uint8_t> isChanged_;
};

void SegmentGrower::gather(const std::vector<uint32_t>& facetOf) {
    const uint32_t count = static_cast<uint32_t>(forest_.facets.size());
    segments_.resize(count);
    normals_.resize(count);
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
    nextFacet_.assign(count, kNoNumber);
    for (uint32_t f = 0; f < count; ++f) {
        Segment& segment = segments_[f];
        segment.triangles = forest_.facets[f].size();
        segment.node = segment.first = segment.last = f;
        for (uint32_t t : forest_.facets[f]) {
            segment.area += mesh_.area[t];
            segment.sum += mesh_.area[t] * mesh_.normal[t];
        }
        normals_[f] = glm::normalize(segment.sum);
        for (uint32_t t : forest_.facets[f]) {
            for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
                const uint32_t other = mesh_.opposite[h];
                if (other == kNoNumber || facetOf[other / 3] == f) continue;
                const double length =
                    glm::distance(mesh_.corners[h], mesh_.corners[WeldedMesh::nextCorner(h)]);
                const bool smooth = glm::dot(mesh_.normal[t], mesh_.normal[other / 3]) > kCreaseCosine;
                segment.neighbours.push_back({facetOf[other / 3], length, smooth ? length : 0.0, false});
            }
        }
    }
    for (uint32_t f = 0; f < count; ++f)
        resolve(f);
}

/// A facet is a wall where it is far larger than what it runs smoothly into, as bevels and fillets.
void SegmentGrower::findWalls() {
    wall_.assign(segments_.size(), 1);
    for (uint32_t f = 0; f < segments_.size(); ++f)
        for (const Neighbour& neighbour : segments_[f].neighbours)
            if (glm::dot(normals_[f], normals_[neighbour.segment]) > kSmoothCosine &&
                segments_[f].area < kWall * segments_[neighbour.segment].area)
                wall_[f] = 0;
}

uint32_t SegmentGrower::find(uint32_t segment) {
    while (parent_[segment] != segment)
        segment = parent_[segment] = parent_[parent_[segment]];
    return segment;
}

/// Names the neighbours anew that have been joined since, each once.
void SegmentGrower::resolve(uint32_t segment) {
    std::vector<Neighbour>& list = segments_[segment].neighbours;
    for (Neighbour& neighbour : list)
        neighbour.segment = find(neighbour.segment);
    std::stable_sort(list.begin(), list.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.segment < b.segment; });
    size_t kept = 0;
    for (size_t i = 0; i < list.size(); ++i) {
        if (list[i].segment == segment) continue;
        if (kept > 0 && list[kept - 1].segment == list[i].segment) {
            list[kept - 1].length += list[i].length;
            list[kept - 1].smooth += list[i].smooth;
            list[kept - 1].refused |= list[i].refused;
        } else {
            list[kept++] = list[i];
        }
    }
    list.resize(kept);
}

/// Returns the variance of normals of the two together per border that goes away [m]; infinity where they may
/// not be joined.
double SegmentGrower::costOf(uint32_t a, const Neighbour& neighbour) const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const uint32_t b = neighbour.segment;
    if (wall_[a] || wall_[b] || neighbour.refused || neighbour.smooth < 0.5 * neighbour.length) return kNever;
    const Segment &left = segments_[a], &right = segments_[b];
    if (left.triangles + right.triangles > kMostTriangles) return kNever;
    const bool swapped = b < a; // sums are the same from either side
    const glm::dvec3 sum = swapped ? right.sum + left.sum : left.sum + right.sum;
    const double area = left.area + right.area, variance = area - glm::dot(sum, sum) / area;
    return variance > kMostVariance * area ? kNever : variance / neighbour.length;
}

uint32_t SegmentGrower::cheapest(uint32_t segment) {
    resolve(segment);
    double least = std::numeric_limits<double>::infinity();
    uint32_t best = kNoNumber;
    std::pair<uint32_t, uint32_t>
        name; // of the pair, which decides between equal costs from both sides alike
    for (const Neighbour& neighbour : segments_[segment].neighbours) {
        const double cost = costOf(segment, neighbour);
        const std::pair<uint32_t, uint32_t> own = std::minmax({segment, neighbour.segment});
        if (!(cost < least) && !(best != kNoNumber && cost == least && own < name)) continue;
        least = cost;
        best = neighbour.segment;
        name = own;
    }
    return best;
}

void SegmentGrower::refuse(uint32_t a, uint32_t b) {
    for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)})
        for (Neighbour& neighbour : segments_[one].neighbours)
            if (find(neighbour.segment) == other) neighbour.refused = true;
}

bool SegmentGrower::inCone(uint32_t segment, const glm::dvec3& axis) const {
    for (uint32_t f = segments_[segment].first; f != kNoNumber; f = nextFacet_[f])
        if (glm::dot(normals_[f], axis) < kConeCosine) return false;
    return true;
}

bool SegmentGrower::allowed(uint32_t a, uint32_t b) const {
    const glm::dvec3 sum = segments_[a].sum + segments_[b].sum;
    const double area = segments_[a].area + segments_[b].area, squared = glm::dot(sum, sum);
    if (area - squared / area < kFlatVariance * area) return true;
    const glm::dvec3 axis = sum / std::sqrt(squared);
    return inCone(a, axis) && inCone(b, axis);
}

void SegmentGrower::join(uint32_t a, uint32_t b) {
    Segment &left = segments_[a], &right = segments_[b];
    const uint32_t node = static_cast<uint32_t>(forest_.facets.size() + forest_.parts.size());
    forest_.parts.push_back({left.node, right.node});
    left.node = node;
    left.area += right.area;
    left.triangles += right.triangles;
    left.sum += right.sum;
    nextFacet_[left.last] = right.first;
    left.last = right.last;
    parent_[b] = a;
    left.neighbours.insert(left.neighbours.end(), right.neighbours.begin(), right.neighbours.end());
    std::vector<Neighbour>().swap(right.neighbours);
    resolve(a);
}

/// Joins the pairs of which each is the other's cheapest neighbour; the cheapest pair of all is among them.
void SegmentGrower::round() {
    for (uint32_t segment : changed_) {
        choice_[segment] = cheapest(segment);
        isChanged_[segment] = 0;
    }
    std::vector<uint32_t> touched;
    const auto touch = [&](uint32_t segment) {
        if (!isChanged_[segment]) touched.push_back(segment);
        isChanged_[segment] = 1;
    };
    for (uint32_t segment : changed_) {
        const uint32_t other = choice_[segment];
        if (other == kNoNumber || parent_[segment] != segment || choice_[other] != segment) continue;
        const uint32_t a = std::min(segment, other), b = std::max(segment, other);
        choice_[a] = choice_[b] = kNoNumber;
        if (allowed(a, b)) {
            join(a, b);
            for (const Neighbour& neighbour : segments_[a].neighbours)
                touch(neighbour.segment);
        } else {
            refuse(a, b);
            touch(b);
        }
        touch(a);
    }
    std::erase_if(touched, [&](uint32_t segment) {
        if (parent_[segment] == segment) return false;
        isChanged_[segment] = 0;
        return true;
    });
    changed_ = std::move(touched);
}

void SegmentGrower::run() {
    FacetGrower facets(mesh_);
    facets.run(forest_.facets);
    gather(facets.facetOf());
    findWalls();
    choice_.assign(segments_.size(), kNoNumber);
    isChanged_.assign(segments_.size(), 0);
    changed_.resize(segments_.size());
    std::iota(changed_.begin(), changed_.end(), 0u);
    while (!changed_.empty())
        round();
    for (uint32_t f = 0; f < segments_.size(); ++f)
        if (parent_[f] == f) forest_.roots.push_back(segments_[f].node);
}

} // namespace

std::vector<uint32_t> SegmentForest::trianglesOf(uint32_t node) const {
    std::vector<uint32_t> triangles, open = {node};
    while (!open.empty()) {
        const uint32_t top = open.back();
        open.pop_back();
        if (top < facets.size()) {
            triangles.insert(triangles.end(), facets[top].begin(), facets[top].end());
        } else {
            open.push_back(parts[top - facets.size()][1]);
            open.push_back(parts[top - facets.size()][0]);
        }
    }
    return triangles;
}

SegmentForest growSegments(const WeldedMesh& mesh) {
    SegmentForest forest;
    SegmentGrower(mesh, forest).run();
    return forest;
}

} // namespace relume
