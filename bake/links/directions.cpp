#include "bake/links/directions.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>

namespace relume {
namespace {

using Point = glm::dvec2;

constexpr double kMirror = 2.0; // radii to the mirror image behind the border, of the distance to the border
// The corners of a triangle around all are so far away that the disc sees them as directions.
constexpr double kFar = 1e3;
constexpr uint32_t kNoNeighbour = 0xffffffffu;

double square(Point p) {
    return glm::dot(p, p);
}

/// A triangle of the Delaunay triangulation, counter-clockwise. next[k] is the one across the edge from
/// corner k to the next.
struct Triangle {
    std::array<uint32_t, 3> corner{};
    std::array<uint32_t, 3> next{kNoNeighbour, kNoNeighbour, kNoNeighbour};
    Point centre{0.0}; // of its circumscribed circle
    double radius2 = 0;
    bool isAlive = true;
};

/// A place where a point could be put; it is valid as long as both triangles are alive.
struct Candidate {
    double radius = 0; // of the empty circle around it
    Point at{0.0};
    uint32_t triangle = kNoNeighbour, other = kNoNeighbour;
    bool operator<(const Candidate& c) const {
        // The set is symmetric, so many are equal but for rounding, which must not decide. Then one from
        // anywhere is taken: in order of place a half-filled generation would be all on one side.
        constexpr double kEqual = 1e-9;
        if (std::abs(radius - c.radius) > kEqual) return radius < c.radius;
        return anyOrder() < c.anyOrder();
    }
    double anyOrder() const { return glm::fract(glm::dot(at, Point(37.17, 53.71))); }
};

/// Makes a Delaunay triangulation by insertion [Bowyer 1981; Watson 1981] with the candidates of its dual.
class DiscFiller {
public:
    DiscFiller();
    void insert(Point p, uint32_t within);
    Candidate best();
    std::vector<Point> points; // the three far corners first

private:
    uint32_t addTriangle(uint32_t a, uint32_t b, uint32_t c);
    bool contains(const Triangle& t, Point p) const { return square(p - t.centre) < t.radius2 * (1 - 1e-12); }
    void addCandidates(uint32_t triangle);
    void addEdgeCandidate(uint32_t triangle, uint32_t other, Point end);

    std::vector<Triangle> triangles_;
    std::priority_queue<Candidate> candidates_;
    std::vector<uint32_t> cavity_, fresh_;
};

DiscFiller::DiscFiller() {
    for (int k = 0; k < 3; ++k)
        points.push_back(kFar * Point(std::cos(2.1 * k + 0.1), std::sin(2.1 * k + 0.1)));
    addTriangle(0, 1, 2);
}

uint32_t DiscFiller::addTriangle(uint32_t a, uint32_t b, uint32_t c) {
    Triangle t;
    t.corner = {a, b, c};
    const Point u = points[b] - points[a], v = points[c] - points[a];
    const double d = 2 * (u.x * v.y - u.y * v.x);
    const Point offset = Point(v.y * square(u) - u.y * square(v), u.x * square(v) - v.x * square(u)) / d;
    t.centre = points[a] + offset;
    t.radius2 = square(offset);
    triangles_.push_back(t);
    return static_cast<uint32_t>(triangles_.size() - 1);
}

// Replaces all triangles whose circle holds p by the fan from p to their outline. `within` is one of them.
void DiscFiller::insert(Point p, uint32_t within) {
    const auto corner = static_cast<uint32_t>(points.size());
    points.push_back(p);
    cavity_ = {within};
    triangles_[within].isAlive = false;
    for (size_t i = 0; i < cavity_.size(); ++i) {
        for (const uint32_t n : triangles_[cavity_[i]].next) {
            if (n == kNoNeighbour || !triangles_[n].isAlive || !contains(triangles_[n], p)) continue;
            triangles_[n].isAlive = false;
            cavity_.push_back(n);
        }
    }
    fresh_.clear();
    for (const uint32_t dead : cavity_) {
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t outside = triangles_[dead].next[k];
            if (outside != kNoNeighbour && !triangles_[outside].isAlive) continue;
            const uint32_t a = triangles_[dead].corner[k], b = triangles_[dead].corner[(k + 1) % 3];
            const uint32_t t = addTriangle(a, b, corner);
            triangles_[t].next[0] = outside;
            if (outside != kNoNeighbour)
                for (uint32_t m = 0; m < 3; ++m)
                    if (triangles_[outside].corner[m] == b) triangles_[outside].next[m] = t;
            fresh_.push_back(t);
        }
    }
    // The fan's spokes are joined: where one triangle's edge ends the next one's begins.
    for (const uint32_t t : fresh_)
        for (const uint32_t o : fresh_)
            if (triangles_[o].corner[0] == triangles_[t].corner[1])
                triangles_[t].next[1] = o, triangles_[o].next[2] = t;
    for (const uint32_t t : fresh_)
        addCandidates(t);
}

// Returns how far the circle around x through a reaches beyond what the border allows it.
double excess(Point x, Point a) {
    return glm::length(x - a) - kMirror * (1 - glm::length(x));
}

void DiscFiller::addCandidates(uint32_t triangle) {
    const Triangle& t = triangles_[triangle];
    const Point a = points[t.corner[0]];
    const bool isFar = t.corner[0] < 3 || t.corner[1] < 3 || t.corner[2] < 3;
    if (!isFar && excess(t.centre, a) <= 0)
        candidates_.push({std::sqrt(t.radius2), t.centre, triangle, triangle});
    for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t b = t.corner[k], c = t.corner[(k + 1) % 3];
        if (b >= 3 && c >= 3 && t.next[k] != kNoNeighbour) addEdgeCandidate(triangle, t.next[k], points[b]);
    }
}

// Adds where the Voronoi edge between two triangles' centres leaves what the border allows.
void DiscFiller::addEdgeCandidate(uint32_t triangle, uint32_t other, Point a) {
    const Point c0 = triangles_[triangle].centre, c1 = triangles_[other].centre;
    // The edge's nearest point to the border's centre is inside if any is: the search goes both ways from it.
    const Point along = c1 - c0;
    const double length2 = square(along);
    if (!(length2 > 0)) return;
    const double middle = std::clamp(-glm::dot(c0, along) / length2, 0.0, 1.0);
    if (excess(c0 + middle * along, a) > 0) return;
    for (const double end : {0.0, 1.0}) {
        if (excess(c0 + end * along, a) <= 0) continue;
        double in = middle, out = end;
        for (int i = 0; i < 60; ++i) { // to the last bit
            const double half = 0.5 * (in + out);
            (excess(c0 + half * along, a) <= 0 ? in : out) = half;
        }
        const Point at = c0 + in * along;
        candidates_.push({glm::length(at - a), at, triangle, other});
    }
}

Candidate DiscFiller::best() {
    while (true) {
        ASSERT(!candidates_.empty());
        Candidate c = candidates_.top();
        candidates_.pop();
        if (!triangles_[c.triangle].isAlive || !triangles_[c.other].isAlive) continue;
        // A point on the edge between two lies in the circle of at least one.
        if (!contains(triangles_[c.triangle], c.at)) std::swap(c.triangle, c.other);
        return c;
    }
}

} // namespace

std::vector<glm::dvec2> largestEmptyCircleDisc(uint32_t count) {
    ASSERT(count <= kMostDirections);
    DiscFiller filler;
    // The first point is the disc's centre; any direction from it is as good for the second one.
    const Point second(kMirror / (1 + kMirror), 0.0);
    filler.insert({0, 0}, 0);
    for (uint32_t t = 1; filler.points.size() == 4 && t <= 3; ++t)
        filler.insert(second, t);
    while (filler.points.size() < 3 + size_t{count}) {
        const Candidate c = filler.best();
        filler.insert(c.at, c.triangle);
    }
    return {filler.points.begin() + 3, filler.points.begin() + 3 + count};
}

std::vector<glm::dvec2> evenRings(std::vector<glm::dvec2> points) {
    std::vector<uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return square(points[a]) < square(points[b]); });
    for (size_t rank = 0; rank < order.size(); ++rank) {
        const double radius =
            std::sqrt((static_cast<double>(rank) + 0.5) / static_cast<double>(order.size()));
        Point& p = points[order[rank]];
        p = square(p) > 0 ? radius * glm::normalize(p) : Point(radius, 0);
    }
    return points;
}

glm::dvec3 projectedUp(glm::dvec2 point) {
    return {point.x, point.y, std::sqrt(std::max(0.0, 1.0 - square(point)))};
}

} // namespace relume
