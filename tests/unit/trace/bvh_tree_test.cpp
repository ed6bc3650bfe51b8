#include "bake/trace/bvh_tree.h"

#include <algorithm>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

namespace relume {
namespace {

BvhTree::Node leafAt(const glm::vec3& lo, const glm::vec3& hi, uint32_t item) {
    BvhTree::Node leaf;
    leaf.content.box.add(lo);
    leaf.content.box.add(hi);
    leaf.content.area = 1;
    leaf.first = item, leaf.count = 1;
    return leaf;
}

// Joins leaves by their order alone, half by half.
int joinHalves(BvhTree& tree, const std::vector<BvhTree::Node>& leaves, size_t first, size_t last) {
    const auto index = int(tree.nodes.size());
    if (last - first == 1) {
        tree.nodes.push_back(leaves[first]);
        return index;
    }
    tree.nodes.emplace_back();
    const size_t middle = (first + last) / 2;
    const int children[] = {joinHalves(tree, leaves, first, middle), joinHalves(tree, leaves, middle, last)};
    for (int side = 0; side < 2; ++side) {
        tree.nodes[size_t(index)].child[side] = children[side];
        tree.nodes[size_t(children[side])].parent = index;
        tree.nodes[size_t(index)].content.add(tree.nodes[size_t(children[side])].content);
    }
    return index;
}

BvhTree joined(const std::vector<BvhTree::Node>& leaves) {
    BvhTree tree;
    joinHalves(tree, leaves, 0, leaves.size());
    return tree;
}

BvhTree randomTree(size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(0, 10), size(0.01f, 0.3f);
    std::vector<BvhTree::Node> leaves;
    for (size_t i = 0; i < count; ++i) {
        const glm::vec3 lo(place(random), place(random), place(random));
        leaves.push_back(leafAt(lo, lo + glm::vec3(size(random), size(random), size(random)), uint32_t(i)));
    }
    return joined(leaves);
}

// Checks links and boxes from a node down, and counts the leaves' items.
void checkBelow(const BvhTree& tree, int index, std::vector<int>& met) {
    const BvhTree::Node& node = tree.nodes.at(size_t(index));
    if (node.leaf()) {
        ++met.at(node.first);
        return;
    }
    BvhContent both;
    for (const int child : node.child) {
        ASSERT_EQ(tree.nodes.at(size_t(child)).parent, index);
        both.add(tree.nodes[size_t(child)].content);
        checkBelow(tree, child, met);
    }
    EXPECT_EQ(both.box.lo, node.content.box.lo);
    EXPECT_EQ(both.box.hi, node.content.box.hi);
    EXPECT_EQ(both.area, node.content.area);
}

TEST(BvhTree, partnersThatWerePartedComeTogether) {
    const auto unit = [](float x, uint32_t item) { return leafAt({x, 0, 0}, {x + 1, 1, 1}, item); };
    // Two pairs of neighbours, each neighbour joined with one of the other pair, beside a box far away.
    BvhTree tree = joined({unit(0, 0), unit(100, 1), unit(1, 2), unit(101, 3),
                           leafAt({0, 500, 0}, {1, 501, 1}, 4), leafAt({0, 502, 0}, {1, 503, 1}, 5),
                           leafAt({0, 504, 0}, {1, 505, 1}, 6), leafAt({0, 506, 0}, {1, 507, 1}, 7)});
    reinsert(tree, nullptr);
    const auto leafOf = [&](uint32_t item) {
        return int(std::find_if(tree.nodes.begin(), tree.nodes.end(),
                                [&](const BvhTree::Node& n) { return n.leaf() && n.first == item; }) -
                   tree.nodes.begin());
    };
    EXPECT_EQ(tree.sibling(leafOf(0)), leafOf(2));
    EXPECT_EQ(tree.sibling(leafOf(1)), leafOf(3));
}

TEST(BvhTree, reinsertionKeepsAllLeavesAndShrinksBoxes) {
    BvhTree tree = randomTree(3000);
    const double before = tree.innerArea();
    reinsert(tree, nullptr);
    std::vector<int> met(3000, 0);
    checkBelow(tree, 0, met);
    EXPECT_EQ(std::count(met.begin(), met.end(), 1), 3000);
    EXPECT_LT(tree.innerArea(), 0.35 * before) << "a tree without any order in it";
    EXPECT_LE(tree.depth(), 48u);
}

TEST(BvhTree, threadsDoNotChangeIt) {
    const auto linksOf = [](const BvhTree& tree) {
        std::vector<int> links;
        for (const BvhTree::Node& node : tree.nodes)
            links.insert(links.end(), {node.parent, node.child[0], node.child[1]});
        return links;
    };
    BvhTree alone = randomTree(5000);
    reinsert(alone, nullptr);
    for (const uint32_t threads : {1u, 3u}) {
        WorkerPool pool(threads);
        BvhTree shared = randomTree(5000);
        reinsert(shared, &pool);
        EXPECT_EQ(linksOf(shared), linksOf(alone)) << threads;
    }
}

TEST(BvhTree, leavesOfNoExtentStayWhereTheyAre) {
    const std::vector<BvhTree::Node> leaves(64, leafAt({1, 1, 1}, {1, 1, 1}, 0));
    BvhTree tree = joined(leaves);
    const BvhTree before = tree;
    reinsert(tree, nullptr);
    for (size_t i = 0; i < tree.nodes.size(); ++i)
        EXPECT_EQ(tree.nodes[i].parent, before.nodes[i].parent);
    EXPECT_EQ(tree.depth(), 6u);
}

} // namespace
} // namespace relume
