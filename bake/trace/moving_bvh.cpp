#include "bake/trace/moving_bvh.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "assets/base/error.h"

namespace relume {

using shader::BvhNode;
using shader::BvhTriangle;

namespace {

constexpr uint32_t kMasked = 0x80000000u; // of BvhTriangle::id
constexpr int kNoTriangle = ~0;           // a leaf of nothing
constexpr uint32_t kRoot = 0;             // whatever is below it

// At most this share of all triangles has a tree of its own. That tree is built anew for each move: one over
// more than half of them saves nothing, and where many objects have moved one after the other, the rest of
// them are better off in the tree of what stands still.
constexpr double kMostOutside = 0.5, kManyOutside = 0.125;
constexpr size_t kManyTimesMoved = 4;
// Boxes that are made anew allow for coordinates that grow by this factor: an object that is dragged out of
// the scene would else have them made anew in every frame.
constexpr float kRoom = 1.25f;

int& childOf(BvhNode& node, uint32_t side) {
    return side == 0 ? node.child0 : node.child1;
}

uint32_t firstOf(int leaf) {
    return uint32_t(~leaf) >> 3;
}
uint32_t countOf(int leaf) {
    return uint32_t(~leaf) & 7u;
}

bool isPoint(const WorldMesh& mesh, uint32_t triangle) {
    const glm::vec3* corner = &mesh.positions[size_t(triangle) * 3];
    return corner[0] == corner[1] && corner[0] == corner[2];
}

float reachOf(const WorldMesh& mesh, std::span<const uint32_t> triangles) {
    float reach = 0;
    for (const uint32_t t : triangles)
        for (uint32_t k = 0; k < 3; ++k) {
            const glm::vec3 p = glm::abs(mesh.positions[size_t(t) * 3 + k]);
            reach = std::max({reach, p.x, p.y, p.z});
        }
    return reach;
}

// Returns twice the triangle's area.
float areaOf(const BvhTriangle& triangle) {
    return glm::length(glm::cross(triangle.p1 - triangle.p0, triangle.p2 - triangle.p0));
}

} // namespace

MovingBvh::MovingBvh(const WorldMesh& mesh, WorkerPool* pool) : pool_(pool) {
    build(mesh, bvhReach(mesh));
}

void MovingBvh::build(const WorldMesh& mesh, float reach) {
    reach_ = reach;
    margin_ = bvhMargin(reach);
    std::vector<uint32_t> all(mesh.triangleCount());
    for (uint32_t t = 0; t < all.size(); ++t)
        all[t] = t;
    bvh_ = buildBvh(mesh, {.triangles = all, .margin = margin_, .pool = pool_});
    nodes_ = uint32_t(bvh_.nodes.size());
    depth_ = bvh_.depth;
    area_ = 0;
    outside_.clear();
    parents_.clear();
    leaves_.clear();
    boxes_.clear();
}

bool MovingBvh::wantsAnew(size_t outside, size_t moved) const {
    const size_t all = leaves_.empty() ? bvh_.triangles.size() : leaves_.size();
    const double share = double(outside) / double(all);
    const BvhNode& root = bvh_.nodes[kRoot];
    return share > kMostOutside || (share > kManyOutside && outside > kManyTimesMoved * moved) ||
           all + outside >= kMostBvhTriangles || depth_ + 1 > shader::kBvhDepth ||
           root.child0 == root.child1; // a leaf on both sides
}

MovingBvh::Change MovingBvh::follow(const WorldMesh& mesh, std::span<const uint32_t> moved) {
    ASSERT(std::is_sorted(moved.begin(), moved.end()));
    std::vector<uint32_t> outside, leaving;
    std::set_union(outside_.begin(), outside_.end(), moved.begin(), moved.end(), std::back_inserter(outside));
    std::set_difference(moved.begin(), moved.end(), outside_.begin(), outside_.end(),
                        std::back_inserter(leaving));
    Change change;
    const float reach = reachOf(mesh, moved);
    if (reach > reach_ || wantsAnew(outside.size(), moved.size())) {
        build(mesh, reach > reach_ ? kRoom * reach : reach_);
        change.all = true;
        return change;
    }
    if (moved.empty()) return change;
    if (outside_.empty()) findPlaces();
    bvh_.nodes.resize(nodes_ + 1);
    bvh_.triangles.resize(leaves_.size());
    std::vector<uint32_t> leaves;
    for (const uint32_t triangle : leaving)
        leaves.push_back(remove(triangle, change));
    refit(leaves, change);
    outside_ = std::move(outside);
    join(mesh);
    change.nodes.push_back(kRoot);
    for (uint32_t i = nodes_; i < bvh_.nodes.size(); ++i)
        change.nodes.push_back(i);
    for (auto i = uint32_t(leaves_.size()); i < bvh_.triangles.size(); ++i)
        change.triangles.push_back(i);
    for (std::vector<uint32_t>* list : {&change.nodes, &change.triangles}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    return change;
}

// Finds what each node holds and where each triangle is. The root makes room for the node that joins: it
// becomes the last one.
void MovingBvh::findPlaces() {
    bvh_.nodes.push_back(bvh_.nodes[kRoot]);
    parents_.assign(nodes_ + 1, kRoot);
    boxes_.resize(nodes_ + 1);
    leaves_.resize(bvh_.triangles.size());
    const auto place = [&](uint32_t node) {
        for (uint32_t side = 0; side < 2; ++side) {
            const int child = childOf(bvh_.nodes[node], side);
            if (child >= 0) parents_[size_t(child)] = node;
            for (uint32_t i = 0; child < 0 && i < countOf(child); ++i)
                leaves_[bvh_.triangles[firstOf(child) + i].id & ~kMasked] = node << 1 | side;
            boxes_[node].add(boxOf(child));
        }
    };
    for (uint32_t node = nodes_ - 1; node > 0; --node) // children first
        place(node);
    place(nodes_);
    for (const BvhTriangle& triangle : bvh_.triangles)
        area_ += areaOf(triangle);
}

BvhBox MovingBvh::boxOf(int child) const {
    if (child >= 0) return boxes_[size_t(child)];
    BvhBox box;
    for (uint32_t i = 0; i < countOf(child); ++i) {
        const BvhTriangle& triangle = bvh_.triangles[firstOf(child) + i];
        for (const glm::vec3& p : {triangle.p0, triangle.p1, triangle.p2})
            box.add(p);
    }
    return box;
}

// Removes a triangle, whose place the last one of its leaf takes. Returns the leaf's node.
uint32_t MovingBvh::remove(uint32_t triangle, Change& change) {
    const uint32_t node = leaves_[triangle] >> 1;
    int& leaf = childOf(bvh_.nodes[node], leaves_[triangle] & 1u);
    const uint32_t first = firstOf(leaf), count = countOf(leaf);
    uint32_t at = first;
    while ((bvh_.triangles[at].id & ~kMasked) != triangle)
        ++at;
    ASSERT(at < first + count);
    area_ -= areaOf(bvh_.triangles[at]);
    std::swap(bvh_.triangles[at], bvh_.triangles[first + count - 1]);
    leaf = ~int(first << 3 | (count - 1));
    change.triangles.push_back(at);
    return node;
}

// Refits the boxes from the nodes of these leaves up to the root.
void MovingBvh::refit(const std::vector<uint32_t>& leaves, Change& change) {
    std::vector<uint8_t> marked(nodes_ + 1, 0);
    for (uint32_t node : leaves)
        for (; node != kRoot && marked[node] == 0; node = parents_[node]) {
            marked[node] = 1;
            change.nodes.push_back(node);
        }
    // Children come first; the root of the tree stands behind all of them.
    std::sort(change.nodes.begin(), change.nodes.end(), std::greater());
    if (!change.nodes.empty())
        std::rotate(change.nodes.begin(), change.nodes.begin() + 1, change.nodes.end());
    for (const uint32_t index : change.nodes) {
        BvhNode& node = bvh_.nodes[index];
        boxes_[index] = {};
        for (uint32_t side = 0; side < 2; ++side) {
            const BvhBox box = boxOf(childOf(node, side));
            setChildBox(node, int(side), box, margin_);
            boxes_[index].add(box);
        }
    }
}

// Builds the moved triangles' own tree and joins it. Triangles of hidden objects are points, which nothing
// hits.
void MovingBvh::join(const WorldMesh& mesh) {
    std::vector<uint32_t> there;
    for (const uint32_t triangle : outside_)
        if (!isPoint(mesh, triangle)) there.push_back(triangle);
    BvhContent content;
    int child = kNoTriangle;
    bvh_.depth = depth_ + 1;
    if (!there.empty()) {
        const Bvh own = buildBvh(
            mesh, {.triangles = there, .margin = margin_, .level = 1, .pool = pool_, .reinsert = false});
        const auto base = int(bvh_.nodes.size());
        const auto first = uint32_t(bvh_.triangles.size());
        const auto moved = [&](int below) {
            return below >= 0 ? below + base : ~int((firstOf(below) + first) << 3 | countOf(below));
        };
        const BvhNode& top = own.nodes.front();
        const bool leaf = top.child0 == top.child1; // on both sides: it needs no node
        for (BvhNode node : own.nodes) {
            if (leaf) break;
            node.child0 = moved(node.child0);
            node.child1 = moved(node.child1);
            bvh_.nodes.push_back(node);
        }
        for (const BvhTriangle& triangle : own.triangles) {
            content.area += areaOf(triangle);
            bvh_.triangles.push_back(triangle);
            for (const glm::vec3& p : {triangle.p0, triangle.p1, triangle.p2})
                content.box.add(p);
        }
        bvh_.depth = std::max(bvh_.depth, own.depth);
        child = leaf ? moved(top.child0) : base;
    }
    bvh_.nodes[kRoot] = bvhNode({boxes_[nodes_], area_}, int(nodes_), content, child, margin_);
}

} // namespace relume
