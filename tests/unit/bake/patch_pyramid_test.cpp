// This tests the groups of patches that links with a footprint read.
#include "bake/links/patch_pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace relume {
namespace {

using shader::kNoPatch;

constexpr uint32_t kSize = 16;

// Describes a chart on some texels: the position of a texel's centre, and its normal.
struct Chart {
    std::function<bool(uint32_t, uint32_t)> covers;
    std::function<glm::vec3(float, float)> position;
    std::function<glm::vec3(float, float)> normal;
    float area; // [m^2] of each texel
};

const auto kFlat = [](float x, float y) { return glm::vec3(x, y, 0.0f); };
const auto kUp = [](float, float) { return glm::vec3(0, 0, 1); };

PatchSet patchesOf(const std::vector<Chart>& charts) {
    PatchSet set;
    set.scene.size = kSize;
    set.scene.texelToPatch.assign(size_t{kSize} * kSize, kNoPatch);
    for (uint32_t texel = 0; texel < kSize * kSize; ++texel) {
        const uint32_t x = texel % kSize, y = texel / kSize;
        for (uint32_t c = 0; c < charts.size(); ++c) {
            if (!charts[c].covers(x, y)) continue;
            const float u = static_cast<float>(x) + 0.5f, v = static_cast<float>(y) + 0.5f;
            shader::Patch p{};
            p.position = charts[c].position(u, v);
            p.normal = p.shading = charts[c].normal(u, v);
            p.area = charts[c].area;
            p.flags = shader::kPatchSends | texel << shader::kTexelShift;
            set.scene.texelToPatch[texel] = set.count++;
            set.scene.patches.push_back(p);
            set.scene.patchChart.push_back(c);
            break;
        }
    }
    while (set.scene.patches.size() % shader::kChunk != 0) {
        set.scene.patches.push_back({});
        set.scene.patchChart.push_back(kNoChart);
    }
    return set;
}

struct Tree {
    const PatchSet& set;
    const PatchPyramid pyramid = buildPatchPyramid(set);
    const auto& nodeAt(uint32_t index) const {
        return pyramid.nodes[index - static_cast<uint32_t>(set.scene.patches.size())];
    }
    bool isNode(uint32_t index) const { return index >= set.scene.patches.size(); }
    uint32_t parent(uint32_t index) const {
        return isNode(index) ? nodeAt(index).parent : pyramid.parents[index];
    }
    uint32_t root(uint32_t index) const {
        while (parent(index) != kNoPatch)
            index = parent(index);
        return index;
    }
    // Returns the patches below, each with its share.
    std::vector<std::pair<uint32_t, double>> leaves(uint32_t index) const {
        if (!isNode(index)) return {{index, 1.0}};
        std::vector<std::pair<uint32_t, double>> result;
        for (glm::length_t c = 0; c < 4; ++c) {
            const double share = nodeAt(index).shares[c];
            if (share == 0.0) continue;
            for (const auto& [patch, part] : leaves(nodeAt(index).children[c]))
                result.emplace_back(patch, share * part);
        }
        return result;
    }
};

uint32_t firstNode(const PatchSet& set) {
    return static_cast<uint32_t>(set.scene.patches.size());
}

void expectSound(const Tree& tree) {
    const auto nodes = static_cast<uint32_t>(tree.pyramid.nodes.size());
    ASSERT_EQ(tree.pyramid.parents.size(), tree.set.scene.patches.size());
    EXPECT_LT(nodes, tree.set.count);
    EXPECT_TRUE(std::is_sorted(tree.pyramid.levelEnds.begin(), tree.pyramid.levelEnds.end()));
    EXPECT_EQ(tree.pyramid.levelEnds.empty() ? 0u : tree.pyramid.levelEnds.back(), nodes);
    for (uint32_t i = firstNode(tree.set); i < firstNode(tree.set) + nodes; ++i) {
        const auto end = std::upper_bound(tree.pyramid.levelEnds.begin(), tree.pyramid.levelEnds.end(),
                                          i - firstNode(tree.set));
        const uint32_t below =
            firstNode(tree.set) + (end == tree.pyramid.levelEnds.begin() ? 0u : *(end - 1));
        std::set<uint32_t> charts, patches;
        double area = 0;
        const auto leaves = tree.leaves(i);
        for (const auto& [patch, share] : leaves) {
            charts.insert(tree.set.scene.patchChart[patch]);
            patches.insert(patch);
            area += static_cast<double>(tree.set.scene.patches[patch].area);
        }
        EXPECT_EQ(charts.size(), 1u);
        EXPECT_EQ(patches.size(), leaves.size());
        for (const auto& [patch, share] : leaves)
            EXPECT_NEAR(share, static_cast<double>(tree.set.scene.patches[patch].area) / area, 1e-6);
        EXPECT_GT(tree.nodeAt(i).size, (1 - 1e-5) * area);
        for (glm::length_t c = 0; c < 4; ++c) {
            const uint32_t child = tree.nodeAt(i).children[c];
            EXPECT_LT(child, below); // is filled before
            EXPECT_EQ(tree.parent(child), i);
            if (tree.isNode(child)) {
                EXPECT_LE(tree.nodeAt(child).size, tree.nodeAt(i).size);
            }
        }
    }
}

} // namespace

// 16 x 16 texels of 1 m^2 have a node for each square of 2, 4, 8 and 16, as large as it is.
TEST(PatchPyramid, ASquareHasAllItsSquares) {
    const PatchSet set = patchesOf({{[](uint32_t, uint32_t) { return true; }, kFlat, kUp, 1.0f}});
    const Tree tree{set};
    expectSound(tree);
    EXPECT_EQ(tree.pyramid.levelEnds, (std::vector<uint32_t>{64, 80, 84, 85}));
    const uint32_t root = tree.root(0);
    for (uint32_t i = 0; i < set.count; ++i)
        EXPECT_EQ(tree.root(i), root);
    EXPECT_NEAR(tree.nodeAt(root).size, 256.0f, 1e-3f);
    EXPECT_NEAR(tree.nodeAt(root).position.x, 8.0f, 1e-5f);
    EXPECT_NEAR(tree.nodeAt(tree.pyramid.parents[0]).size, 4.0f, 1e-5f);
}

// Two charts with texels of unlike sizes share squares of the grid.
TEST(PatchPyramid, ChartsAreNotMixed) {
    const PatchSet set =
        patchesOf({{[](uint32_t x, uint32_t y) { return x + y < 13; }, kFlat, kUp, 1.0f},
                   {[](uint32_t x, uint32_t y) { return x + y >= 13 && x != 9; },
                    [](float x, float y) { return glm::vec3(3 * x, 3 * y, 7); }, kUp, 9.0f}});
    const Tree tree{set};
    expectSound(tree);
    std::set<uint32_t> roots;
    for (uint32_t i = 0; i < set.count; ++i)
        roots.insert(tree.root(i));
    EXPECT_EQ(roots.size(), 2u);
}

// What is one texel wide counts for as much as it is long.
TEST(PatchPyramid, AStripIsAsWideAsItIsLong) {
    const PatchSet set = patchesOf({{[](uint32_t, uint32_t y) { return y == 5; }, kFlat, kUp, 1.0f}});
    const Tree tree{set};
    expectSound(tree);
    EXPECT_EQ(tree.pyramid.nodes.size(), 15u);
    // Its variance along is n^2 / 12, across 1 / 12; of a square of area A it is A / 6 together.
    EXPECT_NEAR(tree.nodeAt(tree.root(0)).size, 0.5f * (256 + 1), 1e-2f);
}

// The chart is folded along a line between texels 6 and 7: what reaches across it is in no node.
TEST(PatchPyramid, EdgesAreKept) {
    const PatchSet set =
        patchesOf({{[](uint32_t, uint32_t) { return true; },
                    [](float x, float y) { return x < 7 ? glm::vec3(x, y, 0) : glm::vec3(7, y, x - 7); },
                    [](float x, float) { return x < 7 ? glm::vec3(0, 0, 1) : glm::vec3(-1, 0, 0); }, 1.0f}});
    const Tree tree{set};
    expectSound(tree);
    for (uint32_t i = 0; i < tree.pyramid.nodes.size(); ++i) {
        std::set<float> heights;
        for (const auto& [patch, share] : tree.leaves(firstNode(set) + i))
            heights.insert(set.scene.patches[patch].normal.z);
        EXPECT_EQ(heights.size(), 1u);
    }
    EXPECT_EQ(tree.parent(6), kNoPatch); // its square of 2 x 2 holds the fold
    EXPECT_NE(tree.parent(5), kNoPatch);
}

TEST(PatchPyramid, WhatLiesInsideIsLeftOut) {
    PatchSet set = patchesOf({{[](uint32_t, uint32_t) { return true; }, kFlat, kUp, 1.0f}});
    for (uint32_t i = 0; i < 40; ++i)
        set.scene.patches[i].flags &= ~shader::kPatchSends;
    const Tree tree{set};
    expectSound(tree);
    for (uint32_t i = 0; i < set.count; ++i)
        EXPECT_EQ(tree.parent(i) == kNoPatch, i < 40) << i;
}

// The sum over all N directions is the cosine over a hemisphere of this radius, pi r^2.
TEST(Footprint, SharesSumToTheProjectedHemisphere) {
    const float radius = 3.0f;
    for (const uint32_t samples : {16u, 1024u}) {
        const float area = shader::footprintArea(glm::vec3(1, 2, 3), glm::vec3(1, 2, 3 + radius), samples);
        EXPECT_NEAR(area * static_cast<float>(samples), 3.14159265f * radius * radius, 1e-4f);
    }
}

} // namespace relume
