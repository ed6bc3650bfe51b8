#include "bake/trace/bvh_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "assets/base/error.h"

namespace relume {

using shader::BvhNode;
using shader::BvhTriangle;

namespace {

constexpr uint32_t kLeafMax = 4;
constexpr uint32_t kBins = 32;
constexpr float kNodeCost = 1.5f;   // of visiting a node, in triangle tests: measured on an H100
constexpr uint32_t kTaskMin = 8192; // triangles below which another thread costs more than it saves
constexpr uint32_t kTaskLevels = 4; // levels that may fork: 16 pieces, enough to even out on a few cores

struct BvhItem {
    BvhBox box;
    float area = 0; // [m^2], twice the triangle's
    uint32_t triangle = 0;
    glm::vec3 twiceCentre() const { return box.lo + box.hi; }
};

struct Split {
    float cost = std::numeric_limits<float>::infinity();
    int axis = -1;    // -1: none, cut the list in half
    uint32_t bin = 0; // first one of the right side
};

// Maps centres to bins, alike for counting and for parting.
struct Binning {
    glm::vec3 origin, scale;
    uint32_t bins;

    Binning(const BvhBox& centres, uint32_t count)
        : origin(centres.lo), bins(std::min(kBins, 4 + count / 2)) {
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
    BvhBox box;
    uint32_t count = 0;
};

// Tells whether a ray that enters this box is stopped there more likely than in the other, by the triangles'
// share of the box's surface.
bool stopsMoreThan(const BvhContent& content, const BvhContent& other) {
    return content.area * other.box.halfArea() > other.area * content.box.halfArea();
}

// Returns half of a box's extent as the upper half of a float: always above it, by less than a hundredth.
uint32_t halfFloatAbove(double extent) {
    return (std::bit_cast<uint32_t>(float(extent)) >> 16) + 1;
}

class BvhBuilder {
public:
    BvhBuilder(std::vector<BvhItem>& items, WorkerPool* pool) : items_(items), pool_(pool) {}

    // Adds a tree over items [first, last) and returns its root's number.
    int build(BvhTree& tree, uint32_t first, uint32_t last, uint32_t level);

private:
    static Split bestSplit(std::span<const BvhItem> items, const Binning& binning);
    static void sweep(std::span<const Bin> bins, int axis, Split& best);
    uint32_t part(uint32_t first, uint32_t last, uint32_t level);

    std::vector<BvhItem>& items_;
    WorkerPool* pool_;
};

void BvhBuilder::sweep(std::span<const Bin> bins, int axis, Split& best) {
    std::array<float, kBins> rightCost;
    BvhBox box;
    uint32_t count = 0;
    for (size_t i = bins.size(); i-- > 1;) {
        box.add(bins[i].box);
        count += bins[i].count;
        rightCost[i] = box.halfArea() * float(count);
    }
    const uint32_t total = count + bins[0].count;
    BvhBox left;
    uint32_t leftCount = 0;
    for (size_t i = 1; i < bins.size(); ++i) {
        left.add(bins[i - 1].box);
        leftCount += bins[i - 1].count;
        const float cost = left.halfArea() * float(leftCount) + rightCost[i];
        if (leftCount > 0 && leftCount < total && cost < best.cost) best = {cost, axis, uint32_t(i)};
    }
}

Split BvhBuilder::bestSplit(std::span<const BvhItem> items, const Binning& binning) {
    std::array<std::array<Bin, kBins>, 3> bins;
    for (const BvhItem& item : items) {
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
uint32_t BvhBuilder::part(uint32_t first, uint32_t last, uint32_t level) {
    const uint32_t count = last - first;
    const std::span<BvhItem> items(&items_[first], count);
    BvhBox box, centres;
    for (const BvhItem& item : items) {
        box.add(item.box);
        centres.add(item.twiceCentre());
    }
    // Halving the list from here on must still end within the traversal's stack.
    const bool deep = level + uint32_t(std::bit_width(count)) >= shader::kBvhDepth;
    const Binning binning(centres, count);
    const Split split = deep ? Split{} : bestSplit(items, binning);
    if (count <= kLeafMax && box.halfArea() * (float(count) - kNodeCost) <= split.cost) return first;
    if (split.axis >= 0) {
        const auto middle = std::partition(items.begin(), items.end(), [&](const BvhItem& item) {
            return binning.bin(item.twiceCentre()[split.axis], split.axis) < split.bin;
        });
        return first + uint32_t(middle - items.begin());
    }
    const glm::vec3 extent = centres.hi - centres.lo;
    const int widest = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    std::nth_element(items.begin(), items.begin() + count / 2, items.end(),
                     [&](const BvhItem& a, const BvhItem& b) {
                         const float x = a.twiceCentre()[widest], y = b.twiceCentre()[widest];
                         return x != y ? x < y : a.triangle < b.triangle;
                     });
    return first + count / 2;
}

// Puts a subtree that was built elsewhere behind what `tree` has, and returns where its root is.
int append(BvhTree& tree, const BvhTree& subtree, int root) {
    const int base = int(tree.nodes.size());
    for (BvhTree::Node node : subtree.nodes) {
        if (node.parent != BvhTree::kNone) node.parent += base;
        for (int& child : node.child)
            if (child != BvhTree::kNone) child += base;
        tree.nodes.push_back(node);
    }
    return base + root;
}

int BvhBuilder::build(BvhTree& tree, uint32_t first, uint32_t last, uint32_t level) {
    const uint32_t middle = last - first > 1 ? part(first, last, level) : first;
    const int index = int(tree.nodes.size());
    BvhTree::Node& added = tree.nodes.emplace_back();
    if (middle == first) {
        added.first = first, added.count = last - first;
        for (uint32_t i = first; i < last; ++i)
            added.content.add({items_[i].box, items_[i].area});
        return index;
    }
    int child0 = 0, child1 = 0;
    if (pool_ != nullptr && level < kTaskLevels && last - first >= kTaskMin) {
        BvhTree right;
        pool_->run(2, [&](uint32_t side) {
            if (side == 0)
                child0 = build(tree, first, middle, level + 1);
            else
                child1 = build(right, middle, last, level + 1);
        });
        child1 = append(tree, right, child1);
    } else {
        child0 = build(tree, first, middle, level + 1);
        child1 = build(tree, middle, last, level + 1);
    }
    BvhTree::Node& node = tree.nodes[size_t(index)];
    node.child[0] = child0, node.child[1] = child1;
    for (const int child : node.child) {
        tree.nodes[size_t(child)].parent = index;
        node.content.add(tree.nodes[size_t(child)].content);
    }
    return index;
}

// Puts a tree into the form that the shaders walk.
class BvhWriter {
public:
    BvhWriter(const WorldMesh& mesh, std::span<const BvhItem> items, const BvhTree& tree, float margin)
        : mesh_(mesh), items_(items), tree_(tree), margin_(margin) {
        bvh_.nodes.reserve(tree.nodes.size() / 2 + 1);
        bvh_.triangles.reserve(items.size());
    }

    Bvh write(uint32_t level) {
        const int root = place(0, level);
        if (root < 0) { // the traversal begins at a node: one with the leaf on both sides
            const BvhContent& content = tree_.nodes[0].content;
            bvh_.nodes.push_back(bvhNode(content, root, content, root, margin_));
            bvh_.depth = level + 1;
        }
        return std::move(bvh_);
    }

private:
    // Returns the number of a node or, negative, of a leaf.
    int place(int index, uint32_t level) {
        const BvhTree::Node& node = tree_.nodes[size_t(index)];
        if (node.leaf()) return placeLeaf(node);
        const size_t at = bvh_.nodes.size();
        bvh_.nodes.emplace_back();
        bvh_.depth = std::max(bvh_.depth, level + 1);
        const int child0 = place(node.child[0], level + 1), child1 = place(node.child[1], level + 1);
        bvh_.nodes[at] = bvhNode(contentOf(node.child[0]), child0, contentOf(node.child[1]), child1, margin_);
        return int(at);
    }
    const BvhContent& contentOf(int index) const { return tree_.nodes[size_t(index)].content; }

    int placeLeaf(const BvhTree::Node& leaf) {
        const auto first = uint32_t(bvh_.triangles.size());
        for (const BvhItem& item : items_.subspan(leaf.first, leaf.count)) {
            const glm::vec3* corner = &mesh_.positions[size_t(item.triangle) * 3];
            const uint32_t masked = item.triangle >= mesh_.opaqueCount ? 0x80000000u : 0u;
            bvh_.triangles.push_back({corner[0], item.triangle | masked, corner[1], 0, corner[2], 0});
        }
        return ~int(first << 3 | leaf.count);
    }

    const WorldMesh& mesh_;
    std::span<const BvhItem> items_;
    const BvhTree& tree_;
    const float margin_; // [m], added around boxes
    Bvh bvh_;
};

// Moves what gains, unless that makes ways through the tree longer than the traversal's stack.
void reinsertWithin(BvhTree& tree, uint32_t level, WorkerPool* pool) {
    if (tree.nodes.front().leaf()) return;
    BvhTree moved = tree;
    reinsert(moved, pool);
    if (level + moved.depth() <= shader::kBvhDepth) tree = std::move(moved);
}

std::vector<BvhItem> itemsOf(const WorldMesh& mesh, std::span<const uint32_t> triangles) {
    std::vector<BvhItem> items(triangles.size());
    for (uint32_t i = 0; i < items.size(); ++i) {
        items[i].triangle = triangles[i];
        const glm::vec3* corner = &mesh.positions[size_t(triangles[i]) * 3];
        for (uint32_t k = 0; k < 3; ++k)
            items[i].box.add(corner[k]);
        items[i].area = glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
    }
    return items;
}

// The extent of what no ray may enter: its far side comes before its near one, wherever a ray begins.
constexpr float kNothing = -1e30f; // [m]

} // namespace

BvhBox childBox(const BvhNode& node, int child) {
    const glm::vec3 centre = child == 0 ? node.centre0 : node.centre1;
    const glm::vec3 extent = glm::uintBitsToFloat(child == 0 ? node.extents : node.extents << 16u);
    return {centre - extent, centre + extent};
}

void setChildBox(BvhNode& node, int child, const BvhBox& box, float margin) {
    const glm::vec3 centre = box.empty() ? glm::vec3(0.0f) : (box.lo + box.hi) * 0.5f;
    (child == 0 ? node.centre0 : node.centre1) = centre;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent =
            std::max(double(box.hi[axis]) - centre[axis], double(centre[axis]) - box.lo[axis]) + margin;
        const uint32_t half = box.empty() ? std::bit_cast<uint32_t>(kNothing) >> 16 : halfFloatAbove(extent);
        uint32_t& both = node.extents[axis];
        both = child == 0 ? (both & 0xffffu) | half << 16 : (both & 0xffff0000u) | half;
    }
}

// Any-hit traversal takes children in the node's order.
BvhNode bvhNode(const BvhContent& content0, int child0, const BvhContent& content1, int child1,
                float margin) {
    if (stopsMoreThan(content1, content0)) return bvhNode(content1, child1, content0, child0, margin);
    BvhNode node{};
    node.child0 = child0, node.child1 = child1;
    setChildBox(node, 0, content0.box, margin);
    setChildBox(node, 1, content1.box, margin);
    return node;
}

float bvhReach(const WorldMesh& mesh) {
    float reach = 0;
    for (const glm::vec3& p : mesh.positions)
        reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return reach;
}

// The traversal multiplies centre and origin by 1 / direction before it subtracts, so both lose half an ulp
// of the largest coordinate, and the triangle's test takes rays that pass by as closely: making the boxes
// larger by more makes up for it. It is not much more: rays start close to surfaces, whose flat boxes are
// then entered in vain.
float bvhMargin(float reach) {
    return 4 * std::numeric_limits<float>::epsilon() * reach;
}

Bvh buildBvh(const WorldMesh& mesh, WorkerPool* pool) {
    std::vector<uint32_t> all(mesh.triangleCount());
    std::iota(all.begin(), all.end(), 0u);
    return buildBvh(mesh, {.triangles = all, .margin = bvhMargin(bvhReach(mesh)), .pool = pool});
}

Bvh buildBvh(const WorldMesh& mesh, const BvhDesc& desc) {
    ASSERT(!desc.triangles.empty() && desc.triangles.size() < kMostBvhTriangles);
    std::vector<BvhItem> items = itemsOf(mesh, desc.triangles);
    BvhTree tree;
    tree.nodes.reserve(items.size());
    BvhBuilder(items, desc.pool).build(tree, 0, uint32_t(items.size()), desc.level);
    if (desc.reinsert) reinsertWithin(tree, desc.level, desc.pool);
    Bvh bvh = BvhWriter(mesh, items, tree, desc.margin).write(desc.level);
    ASSERT(bvh.depth <= shader::kBvhDepth);
    return bvh;
}

namespace {

double childCost(const Bvh& bvh, int child, double chance) {
    if (child < 0) return chance * double(~child & 7);
    const BvhNode& node = bvh.nodes[size_t(child)];
    const BvhBox box[2] = {childBox(node, 0), childBox(node, 1)};
    BvhBox both = box[0];
    both.add(box[1]);
    const double whole = both.halfArea();
    if (whole <= 0) return chance; // holds nothing that a ray could meet, or points
    return chance + childCost(bvh, node.child0, chance * box[0].halfArea() / whole) +
           childCost(bvh, node.child1, chance * box[1].halfArea() / whole);
}

} // namespace

double bvhCost(const Bvh& bvh) {
    return childCost(bvh, 0, 1.0);
}

} // namespace relume
