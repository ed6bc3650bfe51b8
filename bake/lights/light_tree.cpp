#include "bake/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace relume {
namespace {

using shader::EmitterNode;
using shader::EmitterPolygon;

constexpr double kPi = std::numbers::pi;
// Above this depth splits follow the costs, below it the halves are equal: with at most 2^24 polygons the
// whole stays within kEmitterDepth.
constexpr uint32_t kCostDepth = shader::kEmitterDepth - 24;
constexpr uint32_t kBuckets = 12; // per axis; more hardly changes the tree
constexpr double kFlatAngle =
    1e-5; // [rad], normals that agree so well are one; emitterImportance relies on it

/// All normals within `angle` of axis.
struct Cone {
    glm::dvec3 axis{0, 0, 1};
    double angle = -1; // [rad]; < 0: of no normals
};

Cone unite(const Cone& a, const Cone& b) {
    if (a.angle < 0) return b;
    if (b.angle < 0) return a;
    const Cone& wide = a.angle >= b.angle ? a : b;
    const Cone& slim = a.angle >= b.angle ? b : a;
    const glm::dvec3 turn = glm::cross(wide.axis, slim.axis);
    const double between = std::atan2(glm::length(turn), glm::dot(wide.axis, slim.axis));
    if (between <= kFlatAngle && wide.angle == 0) return wide; // parallel normals
    if (between + slim.angle <= wide.angle) return wide;
    const double angle = 0.5 * (wide.angle + between + slim.angle);
    if (angle >= kPi || glm::length(turn) == 0) return {wide.axis, kPi};
    // The axis is turned about `turn` from the wide cone's axis until both are covered [Rodrigues].
    const glm::dvec3 k = glm::normalize(turn);
    const double by = angle - wide.angle;
    return {glm::normalize(wide.axis * std::cos(by) + glm::cross(k, wide.axis) * std::sin(by)), angle};
}

/// Returns the solid angle that a cone of Lambertian emitters shines into, weighted by cosine: M_omega of the
/// paper for emission within 90 degrees of each normal.
double coneMeasure(const Cone& cone) {
    if (cone.angle < 0) return 0;
    const double o = cone.angle, w = std::min(o + kPi / 2, kPi);
    return 2 * kPi * (1 - std::cos(o)) +
           kPi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
}

struct Bounds {
    glm::dvec3 lo{std::numeric_limits<double>::max()}, hi{std::numeric_limits<double>::lowest()};
    Cone cone;
    double power = 0;

    void add(const Bounds& b) {
        lo = glm::min(lo, b.lo), hi = glm::max(hi, b.hi);
        cone = unite(cone, b.cone);
        power += b.power;
    }
    double cost() const {
        if (cone.angle < 0) return 0;
        const glm::dvec3 e = hi - lo;
        return power * coneMeasure(cone) * (e.x * e.y + e.y * e.z + e.z * e.x);
    }
};

class TreeBuilder {
public:
    explicit TreeBuilder(const std::vector<EmitterPolygon>& polygons);
    std::vector<EmitterNode> build();

private:
    struct Range {
        uint32_t node, first, last, depth; // order_[first .. last)
    };
    Bounds boundsOf(const Range& range) const;
    uint32_t divide(const Range& range);
    uint32_t divideByCost(const Range& range);
    void finish(EmitterNode& node, const Bounds& bounds) const;
    glm::dvec3 centre(uint32_t i) const { return 0.5 * (items_[i].lo + items_[i].hi); }
    /// Returns the box of the centres of a range.
    Bounds centresOf(const Range& range) const;

    std::vector<Bounds> items_;
    std::vector<uint32_t> order_;
    double power_ = 0;
};

TreeBuilder::TreeBuilder(const std::vector<EmitterPolygon>& polygons) : order_(polygons.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    items_.reserve(polygons.size());
    for (const EmitterPolygon& p : polygons) {
        Bounds b;
        for (const glm::vec3& c : {p.c0, p.c1, p.c2, p.c3})
            b.lo = glm::min(b.lo, glm::dvec3(c)), b.hi = glm::max(b.hi, glm::dvec3(c));
        const glm::dvec3 front =
            glm::cross(glm::dvec3(p.c2) - glm::dvec3(p.c0), glm::dvec3(p.c3) - glm::dvec3(p.c1));
        const double size = glm::length(front);
        b.cone = size > 0 ? Cone{front / size, 0} : Cone{{0, 0, 1}, kPi};
        b.power = emitterPower(p);
        power_ += b.power;
        items_.push_back(b);
    }
}

Bounds TreeBuilder::boundsOf(const Range& range) const {
    Bounds sum;
    for (uint32_t i = range.first; i < range.last; ++i)
        sum.add(items_[order_[i]]);
    return sum;
}

Bounds TreeBuilder::centresOf(const Range& range) const {
    Bounds box;
    for (uint32_t i = range.first; i < range.last; ++i)
        box.lo = glm::min(box.lo, centre(order_[i])), box.hi = glm::max(box.hi, centre(order_[i]));
    return box;
}

uint32_t TreeBuilder::divideByCost(const Range& range) {
    const Bounds centres = centresOf(range);
    const glm::dvec3 extent = centres.hi - centres.lo;
    const double longest = std::max({extent.x, extent.y, extent.z});
    const auto bucketOf = [&](uint32_t item, int axis) {
        const double along = (centre(item)[axis] - centres.lo[axis]) / extent[axis];
        return std::min(kBuckets - 1, static_cast<uint32_t>(along * kBuckets));
    };
    double best = std::numeric_limits<double>::max();
    int bestAxis = -1;
    uint32_t bestBucket = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(extent[axis] > 1e-6 * longest)) continue;
        std::array<Bounds, kBuckets> buckets, above;
        for (uint32_t i = range.first; i < range.last; ++i)
            buckets[bucketOf(order_[i], axis)].add(items_[order_[i]]);
        above[kBuckets - 1] = buckets[kBuckets - 1];
        for (uint32_t k = kBuckets - 1; k-- > 0;) {
            above[k] = above[k + 1];
            above[k].add(buckets[k]);
        }
        Bounds below;
        for (uint32_t k = 0; k + 1 < kBuckets; ++k) {
            below.add(buckets[k]);
            if (below.cone.angle < 0 || above[k + 1].cone.angle < 0) continue;
            // Thin boxes are dearer across their longest side.
            const double cost = longest / extent[axis] * (below.cost() + above[k + 1].cost());
            if (cost < best) best = cost, bestAxis = axis, bestBucket = k;
        }
    }
    if (bestAxis < 0) return range.first;
    const auto middle =
        std::stable_partition(order_.begin() + range.first, order_.begin() + range.last,
                              [&](uint32_t i) { return bucketOf(i, bestAxis) <= bestBucket; });
    return static_cast<uint32_t>(middle - order_.begin());
}

// Divides a range and returns where the second child's polygons begin.
uint32_t TreeBuilder::divide(const Range& range) {
    if (range.depth < kCostDepth) {
        const uint32_t middle = divideByCost(range);
        if (middle > range.first && middle < range.last) return middle;
    }
    const Bounds centres = centresOf(range);
    const glm::dvec3 extent = centres.hi - centres.lo;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const uint32_t middle = range.first + (range.last - range.first) / 2;
    std::stable_sort(order_.begin() + range.first, order_.begin() + range.last,
                     [&](uint32_t a, uint32_t b) { return centre(a)[axis] < centre(b)[axis]; });
    return middle;
}

void TreeBuilder::finish(EmitterNode& node, const Bounds& bounds) const {
    node.lo = glm::vec3(bounds.lo), node.hi = glm::vec3(bounds.hi); // the corners' own floats: exact
    node.power = power_ > 0 ? static_cast<float>(bounds.power / power_) : 0.0f;
    node.axis = glm::vec3(bounds.cone.axis);
    // The cosine is rounded so that the cone never gets narrower.
    node.cosCone = bounds.cone.angle > 0
                       ? std::min(static_cast<float>(std::cos(bounds.cone.angle)) - 1e-6f, 1.0f - 1e-6f)
                       : 1.0f;
    node.cosCone = std::max(node.cosCone, -1.0f);
}

std::vector<EmitterNode> TreeBuilder::build() {
    std::vector<EmitterNode> nodes(1);
    if (items_.empty()) {
        nodes[0].axis = {0, 0, 1};
        nodes[0].link = shader::kEmitterLeaf;
        return nodes;
    }
    nodes.reserve(2 * items_.size());
    std::vector<Range> open = {{0, 0, static_cast<uint32_t>(items_.size()), 0}};
    while (!open.empty()) {
        const Range range = open.back();
        open.pop_back();
        finish(nodes[range.node], boundsOf(range));
        if (range.last - range.first == 1) {
            nodes[range.node].link = shader::kEmitterLeaf | order_[range.first];
            continue;
        }
        const uint32_t middle = divide(range), child = static_cast<uint32_t>(nodes.size());
        nodes[range.node].link = child;
        nodes.resize(nodes.size() + 2);
        open.push_back({child + 1, middle, range.last, range.depth + 1});
        open.push_back({child, range.first, middle, range.depth + 1});
    }
    return nodes;
}

} // namespace

double emitterPower(const shader::EmitterPolygon& polygon) {
    const glm::dvec3 radiance(polygon.radiance);
    return double{polygon.area} * (radiance.r + radiance.g + radiance.b) / 3.0;
}

std::vector<EmitterNode> buildLightTree(const std::vector<EmitterPolygon>& polygons) {
    return TreeBuilder(polygons).build();
}

} // namespace relume
