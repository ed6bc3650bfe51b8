#include "bake/trace/bvh_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <future>
#include <limits>
#include <span>

#include "assets/error.h"

namespace relume {

using shader::BvhNode;
using shader::BvhTriangle;

namespace {

constexpr uint32_t kLeafMax = 4;
constexpr uint32_t kBins = 32;
constexpr float kNodeCost = 1.5f;   // of visiting a node, in triangle tests: measured on an H100
constexpr uint32_t kTaskMin = 8192; // triangles below which a thread of its own costs more than it saves
constexpr uint32_t kTaskLevels = 4; // levels that may fork: 16 pieces, enough to even out on a few cores

struct Box {
    glm::vec3 lo{std::numeric_limits<float>::infinity()};
    glm::vec3 hi{-std::numeric_limits<float>::infinity()};

    void add(const glm::vec3& point) { lo = glm::min(lo, point), hi = glm::max(hi, point); }
    void add(const Box& box) { lo = glm::min(lo, box.lo), hi = glm::max(hi, box.hi); }
    float halfArea() const {
        const glm::vec3 d = hi - lo;
        return d.x >= 0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0.0f;
    }
};

struct Item {
    Box box;
    float area = 0; // [m^2], twice the triangle's
    uint32_t triangle = 0;
    glm::vec3 twiceCentre() const { return box.lo + box.hi; }
};

struct Split {
    float cost = std::numeric_limits<float>::infinity();
    int axis = -1;    // -1: none, cut the list in half
    uint32_t bin = 0; // first one of the right side
};

// Maps centres to bins, alike when counting and when parting.
struct Binning {
    glm::vec3 origin, scale;
    uint32_t bins;

    Binning(const Box& centres, uint32_t count) : origin(centres.lo), bins(std::min(kBins, 4 + count / 2)) {
        const glm::vec3 extent = centres.hi - centres.lo;
        for (int axis = 0; axis < 3; ++axis) {
            const float s =
                float(bins) * 0.9999f / extent[axis]; // infinite for a flat axis, which is then left out
            scale[axis] = s < std::numeric_limits<float>::max() ? s : 0.0f;
        }
    }
    uint32_t bin(float centre, int axis) const {
        return std::min(uint32_t((centre - origin[axis]) * scale[axis]), bins - 1);
    }
};

struct Bin {
    Box box;
    uint32_t count = 0;
};

// What a child of a node holds.
struct Content {
    Box box;
    float area = 0; // of the triangles [m^2], twice

    void add(const Item& item) { box.add(item.box), area += item.area; }
    // Whether a ray that enters this box is stopped there more likely: by the triangles' share of its
    // surface.
    bool stopsMoreThan(const Content& other) const {
        return area * other.box.halfArea() > other.area * box.halfArea();
    }
};

// Half of an extent as the upper half of a float: always above, by less than a hundredth.
uint32_t halfFloatAbove(double extent) {
    return (std::bit_cast<uint32_t>(float(extent)) >> 16) + 1;
}

// Nodes of a subtree, their indices counted from its own root.
struct Piece {
    std::vector<BvhNode> nodes;
    uint32_t depth = 0;
};

class Builder {
public:
    Builder(std::vector<Item>& items, float margin) : items_(items), margin_(margin) {}

    // Adds a tree over items [first, last) and returns its root's number: that of a node or, negative, of a
    // leaf.
    int build(Piece& piece, uint32_t first, uint32_t last, uint32_t level);
    BvhNode joined(const Content& content0, int child0, const Content& content1, int child1) const;
    Content contentOf(uint32_t first, uint32_t last) const;

private:
    static Split bestSplit(std::span<const Item> items, const Binning& binning);
    static void sweep(std::span<const Bin> bins, int axis, Split& best);
    uint32_t part(uint32_t first, uint32_t last, uint32_t level);

    std::vector<Item>& items_;
    float margin_; // [m], added around boxes
};

void Builder::sweep(std::span<const Bin> bins, int axis, Split& best) {
    std::array<float, kBins> rightCost;
    Box box;
    uint32_t count = 0;
    for (size_t i = bins.size(); i-- > 1;) {
        box.add(bins[i].box);
        count += bins[i].count;
        rightCost[i] = box.halfArea() * float(count);
    }
    const uint32_t total = count + bins[0].count;
    Box left;
    uint32_t leftCount = 0;
    for (size_t i = 1; i < bins.size(); ++i) {
        left.add(bins[i - 1].box);
        leftCount += bins[i - 1].count;
        const float cost = left.halfArea() * float(leftCount) + rightCost[i];
        if (leftCount > 0 && leftCount < total && cost < best.cost) best = {cost, axis, uint32_t(i)};
    }
}

Split Builder::bestSplit(std::span<const Item> items, const Binning& binning) {
    std::array<std::array<Bin, kBins>, 3> bins;
    for (const Item& item : items) {
        const glm::vec3 centre = item.twiceCentre();
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = bins[size_t(axis)][binning.bin(centre[axis], axis)];
            bin.box.add(item.box);
            ++bin.count;
        }
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis)
        if (binning.scale[axis] > 0) sweep(std::span(bins[size_t(axis)]).first(binning.bins), axis, best);
    return best;
}

// Parts the items of a node in two and returns where the second part begins; `first` if they had better stay
// together.
uint32_t Builder::part(uint32_t first, uint32_t last, uint32_t level) {
    const uint32_t count = last - first;
    const std::span<Item> items(&items_[first], count);
    Box box, centres;
    for (const Item& item : items) {
        box.add(item.box);
        centres.add(item.twiceCentre());
    }
    // Halving from here on must still end within the traversal's stack.
    const bool deep = level + uint32_t(std::bit_width(count)) >= shader::kBvhDepth;
    const Binning binning(centres, count);
    const Split split = deep ? Split{} : bestSplit(items, binning);
    if (count <= kLeafMax && box.halfArea() * (float(count) - kNodeCost) <= split.cost) return first;
    if (split.axis >= 0) {
        const auto middle = std::partition(items.begin(), items.end(), [&](const Item& item) {
            return binning.bin(item.twiceCentre()[split.axis], split.axis) < split.bin;
        });
        return first + uint32_t(middle - items.begin());
    }
    const glm::vec3 extent = centres.hi - centres.lo;
    const int widest = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    std::nth_element(items.begin(), items.begin() + count / 2, items.end(),
                     [&](const Item& a, const Item& b) {
                         const float x = a.twiceCentre()[widest], y = b.twiceCentre()[widest];
                         return x != y ? x < y : a.triangle < b.triangle;
                     });
    return first + count / 2;
}

Content Builder::contentOf(uint32_t first, uint32_t last) const {
    Content content;
    for (uint32_t i = first; i < last; ++i)
        content.add(items_[i]);
    return content;
}

// The child that more likely stops a ray comes first: any-hit traversal takes them in this order.
BvhNode Builder::joined(const Content& content0, int child0, const Content& content1, int child1) const {
    if (content1.stopsMoreThan(content0)) return joined(content1, child1, content0, child0);
    const Box &box0 = content0.box, &box1 = content1.box;
    BvhNode node{};
    node.centre0 = (box0.lo + box0.hi) * 0.5f, node.child0 = child0;
    node.centre1 = (box1.lo + box1.hi) * 0.5f, node.child1 = child1;
    for (int axis = 0; axis < 3; ++axis) {
        const auto extent = [&](const Box& box, float centre) {
            return halfFloatAbove(std::max(double(box.hi[axis]) - centre, double(centre) - box.lo[axis]) +
                                  margin_);
        };
        node.extents[axis] = extent(box0, node.centre0[axis]) << 16 | extent(box1, node.centre1[axis]);
    }
    return node;
}

// Puts a subtree built elsewhere behind what `piece` has.
int append(Piece& piece, const Piece& subtree, int root) {
    if (root < 0) return root;
    const int base = int(piece.nodes.size());
    for (BvhNode node : subtree.nodes) {
        if (node.child0 >= 0) node.child0 += base;
        if (node.child1 >= 0) node.child1 += base;
        piece.nodes.push_back(node);
    }
    piece.depth = std::max(piece.depth, subtree.depth);
    return base + root;
}

int Builder::build(Piece& piece, uint32_t first, uint32_t last, uint32_t level) {
    const uint32_t middle = last - first > 1 ? part(first, last, level) : first;
    if (middle == first) return ~int(first << 3 | (last - first));
    const size_t index = piece.nodes.size();
    piece.nodes.emplace_back();
    piece.depth = std::max(piece.depth, level + 1);
    int child0, child1;
    if (level < kTaskLevels && last - first >= kTaskMin) {
        Piece right;
        auto other = std::async(std::launch::async, [&] { return build(right, middle, last, level + 1); });
        child0 = build(piece, first, middle, level + 1);
        child1 = append(piece, right, other.get());
    } else {
        child0 = build(piece, first, middle, level + 1);
        child1 = build(piece, middle, last, level + 1);
    }
    piece.nodes[index] = joined(contentOf(first, middle), child0, contentOf(middle, last), child1);
    return int(index);
}

std::vector<Item> itemsOf(const WorldMesh& mesh, Box& bounds) {
    std::vector<Item> items(mesh.triangleCount());
    for (uint32_t t = 0; t < items.size(); ++t) {
        items[t].triangle = t;
        const glm::vec3* corner = &mesh.positions[size_t(t) * 3];
        for (uint32_t i = 0; i < 3; ++i)
            items[t].box.add(corner[i]);
        items[t].area = glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
        bounds.add(items[t].box);
    }
    return items;
}

} // namespace

BvhBox childBox(const BvhNode& node, int child) {
    const glm::vec3 centre = child == 0 ? node.centre0 : node.centre1;
    const glm::vec3 extent = glm::uintBitsToFloat(child == 0 ? node.extents : node.extents << 16u);
    return {centre - extent, centre + extent};
}

Bvh buildBvh(const WorldMesh& mesh) {
    ASSERT(mesh.triangleCount() > 0 && mesh.triangleCount() < 1u << 26);
    Box bounds;
    std::vector<Item> items = itemsOf(mesh, bounds);
    // The traversal multiplies centre and origin by 1 / direction before it subtracts, so both lose half an
    // ulp of the largest coordinate, and the triangle's test takes rays that pass by as closely: making the
    // boxes larger by more makes up for it. Not by much more: rays start close to surfaces, whose flat boxes
    // are then entered in vain.
    const glm::vec3 reach = glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi));
    const float margin = 4 * std::numeric_limits<float>::epsilon() * std::max({reach.x, reach.y, reach.z});

    Builder builder(items, margin);
    Piece piece;
    piece.nodes.reserve(items.size());
    const int root = builder.build(piece, 0, uint32_t(items.size()), 0);
    if (root < 0) { // the traversal begins at a node: one with the leaf on both sides
        const Content content = builder.contentOf(0, uint32_t(items.size()));
        piece.nodes.push_back(builder.joined(content, root, content, root));
        piece.depth = 1;
    }
    Bvh bvh{std::move(piece.nodes), {}, piece.depth};
    ASSERT(bvh.depth <= shader::kBvhDepth);
    bvh.triangles.reserve(items.size());
    for (const Item& item : items) {
        const glm::vec3* corner = &mesh.positions[size_t(item.triangle) * 3];
        const uint32_t masked = item.triangle >= mesh.opaqueCount ? 0x80000000u : 0u;
        bvh.triangles.push_back({corner[0], item.triangle | masked, corner[1], 0, corner[2], 0});
    }
    return bvh;
}

namespace {

double childCost(const Bvh& bvh, int child, double chance) {
    if (child < 0) return chance * double(~child & 7);
    const BvhNode& node = bvh.nodes[size_t(child)];
    Box box[2], both;
    for (int side = 0; side < 2; ++side) {
        const BvhBox bounds = childBox(node, side);
        box[side].lo = bounds.lo, box[side].hi = bounds.hi;
        both.add(box[side]);
    }
    const double whole = both.halfArea();
    return chance + childCost(bvh, node.child0, chance * box[0].halfArea() / whole) +
           childCost(bvh, node.child1, chance * box[1].halfArea() / whole);
}

} // namespace

double bvhCost(const Bvh& bvh) {
    return childCost(bvh, 0, 1.0);
}

} // namespace relume
