#include "bake/trace/bvh_tree.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace relume {
namespace {

using Node = BvhTree::Node;

constexpr int kTop = 0;
// The share of nodes that are looked at; the others' boxes are small. All of them take three times as long
// for one or two hundredths of the nodes that rays visit.
constexpr double kLookedAt = 0.3;
constexpr size_t kAlways = 8192; // so many nodes are looked at in no time
constexpr uint32_t kMostRounds = 4;
constexpr double kLeastGain = 0.01; // of a round, below which it is the last one
constexpr uint32_t kPortion = 512;  // nodes that a thread looks at before it takes more

float halfAreaOfBoth(const BvhBox& a, const BvhBox& b) {
    BvhBox both = a;
    both.add(b);
    return both.halfArea();
}

// The best place for a subtree: between a node and its parent.
struct Move {
    float gain = 0; // by which the half areas of inner nodes get less [m^2]
    int node = BvhTree::kNone, target = BvhTree::kNone;
};

// Searches the place where a subtree gains most. With the subtree its parent goes away and comes back above
// the target. The search climbs from there to the root; on its way boxes shrink, and each subtree beside it
// is searched by branch and bound.
class PlaceSearch {
public:
    PlaceSearch(const BvhTree& tree, int node)
        : tree_(tree), box_(of(node).content.box), area_(box_.halfArea()) {
        best_.node = node;
    }

    // The root keeps its children.
    Move find() {
        const int parent = of(best_.node).parent;
        if (parent == kTop) return best_;
        const int sibling = tree_.sibling(best_.node);
        float gain = of(parent).content.box.halfArea(); // of the parent that goes away
        BvhBox left = of(sibling).content.box;          // what the node on the way up then holds
        int pivot = parent, beside = sibling;
        searchBelow(beside, gain, sibling);
        while (pivot != kTop) {
            beside = tree_.sibling(pivot);
            searchBelow(beside, gain, sibling);
            pivot = of(pivot).parent;
            left.add(of(beside).content.box);
            gain += of(pivot).content.box.halfArea() - left.halfArea();
        }
        return best_;
    }

private:
    struct Place {
        int node;
        float gain; // so far: what goes away, less by how much nodes above this one grow
    };
    const Node& of(int node) const { return tree_.nodes[size_t(node)]; }

    // The place beside the sibling is where the subtree is now.
    void searchBelow(int top, float gain, int sibling) {
        stack_.assign(1, {top, gain});
        while (!stack_.empty()) {
            const Place place = stack_.back();
            stack_.pop_back();
            // A new parent's box is no smaller than the subtree's own.
            if (place.gain - area_ <= best_.gain) continue;
            const Node& node = of(place.node);
            const float both = halfAreaOfBoth(node.content.box, box_);
            if (place.gain - both > best_.gain && place.node != sibling)
                best_.gain = place.gain - both, best_.target = place.node;
            const float below = place.gain - (both - node.content.box.halfArea());
            if (node.leaf() || below - area_ <= best_.gain) continue;
            stack_.push_back({node.child[0], below});
            stack_.push_back({node.child[1], below});
        }
    }

    const BvhTree& tree_;
    const BvhBox box_;
    const float area_;
    Move best_;
    std::vector<Place> stack_;
};

// Returns the nodes with the largest boxes, the root left out.
std::vector<int> largest(const BvhTree& tree) {
    std::vector<std::pair<float, int>> byArea;
    byArea.reserve(tree.nodes.size());
    for (int i = 1; i < int(tree.nodes.size()); ++i)
        byArea.emplace_back(tree.nodes[size_t(i)].content.box.halfArea(), i);
    const size_t count =
        std::min(byArea.size(), std::max(kAlways, size_t(kLookedAt * double(byArea.size()))));
    std::nth_element(byArea.begin(), byArea.begin() + long(count), byArea.end(), std::greater());
    std::vector<int> nodes(count);
    std::transform(byArea.begin(), byArea.begin() + long(count), nodes.begin(),
                   [](const auto& entry) { return entry.second; });
    return nodes;
}

void replaceChild(BvhTree& tree, int parent, int from, int to) {
    Node& node = tree.nodes[size_t(parent)];
    node.child[node.child[0] == from ? 0 : 1] = to;
    tree.nodes[size_t(to)].parent = parent;
}

void hold(BvhTree& tree, int node) {
    Node& holder = tree.nodes[size_t(node)];
    holder.content = tree.nodes[size_t(holder.child[0])].content;
    holder.content.add(tree.nodes[size_t(holder.child[1])].content);
}

void holdFrom(BvhTree& tree, int node) {
    for (; node != BvhTree::kNone; node = tree.nodes[size_t(node)].parent)
        hold(tree, node);
}

void apply(BvhTree& tree, const Move& move) {
    const int parent = tree.nodes[size_t(move.node)].parent;
    const int above = tree.nodes[size_t(parent)].parent;
    replaceChild(tree, above, parent, tree.sibling(move.node));
    replaceChild(tree, tree.nodes[size_t(move.target)].parent, move.target, parent);
    tree.nodes[size_t(parent)].child[0] = move.target;
    tree.nodes[size_t(parent)].child[1] = move.node;
    tree.nodes[size_t(move.target)].parent = parent;
    holdFrom(tree, above);
    holdFrom(tree, parent);
}

// Does moves that were found at the same time, those that gain most first. What came before may have changed
// what a later one gains and where, so each is searched again.
void applyAll(BvhTree& tree, std::vector<Move>& moves) {
    std::sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) {
        return a.gain != b.gain ? a.gain > b.gain : a.node < b.node;
    });
    for (const Move& found : moves) {
        const Move move = PlaceSearch(tree, found.node).find();
        if (move.target != BvhTree::kNone) apply(tree, move);
    }
}

} // namespace

double BvhTree::innerArea() const {
    double sum = 0;
    for (size_t i = 1; i < nodes.size(); ++i)
        if (!nodes[i].leaf()) sum += nodes[i].content.box.halfArea();
    return sum;
}

uint32_t BvhTree::depth() const {
    uint32_t most = 0;
    std::vector<std::pair<int, uint32_t>> open{{kTop, 0}};
    while (!open.empty()) {
        const auto [index, above] = open.back();
        open.pop_back();
        const Node& node = nodes[size_t(index)];
        most = std::max(most, above);
        if (node.leaf()) continue;
        for (const int child : node.child)
            open.emplace_back(child, above + 1);
    }
    return most;
}

void reinsert(BvhTree& tree, WorkerPool* pool) {
    double before = tree.innerArea();
    const std::vector<int> nodes = largest(tree);
    for (uint32_t round = 0; round < kMostRounds; ++round) {
        std::vector<Move> moves(nodes.size());
        const auto search = [&](uint32_t portion) {
            const size_t first = size_t{portion} * kPortion;
            for (size_t i = first; i < std::min(first + kPortion, nodes.size()); ++i)
                moves[i] = PlaceSearch(tree, nodes[i]).find();
        };
        const auto portions = uint32_t((nodes.size() + kPortion - 1) / kPortion);
        if (pool != nullptr)
            pool->run(portions, search);
        else
            for (uint32_t portion = 0; portion < portions; ++portion)
                search(portion);
        std::erase_if(moves, [](const Move& move) { return move.target == BvhTree::kNone; });
        applyAll(tree, moves);
        const double after = tree.innerArea();
        if (after > before * (1 - kLeastGain)) return;
        before = after;
    }
}

} // namespace relume
