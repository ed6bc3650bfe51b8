#include "bake/validity/step_aside.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

// Returns the cover of a texel of 1 x 1 m with its point in the middle.
shader::PatchCover squareCover() {
    return {.du = {1, 0, 0},
            .cells = 0,
            .dv = {0, 1, 0},
            .place = shader::kCoverPlaces / 2 | shader::kCoverPlaces / 2 << 16};
}

constexpr uint32_t cellAt(uint32_t column, uint32_t row) {
    return row * shader::kCoverEdge + column;
}

std::vector<uint32_t> tried(const shader::PatchCover& cover, uint32_t cells) {
    const CellsToTry found = cellsToTry(cover, cells);
    return {found.cells.begin(), found.cells.begin() + found.count};
}

OwnPoint pointAt(uint32_t patch, float x) {
    return {.patch = patch, .position = {x, 0, 0}, .place = 1, .cells = 2};
}

} // namespace

TEST(StepAside, TriesTheNearestCellAndTheFarthestFromThat) {
    const uint32_t cells = 1u << cellAt(0, 0) | 1u << cellAt(3, 3) | 1u << cellAt(4, 2) | 1u << cellAt(4, 4);
    EXPECT_EQ(tried(squareCover(), cells), (std::vector{cellAt(3, 3), cellAt(0, 0)}));
    EXPECT_EQ(tried(squareCover(), 1u << cellAt(4, 2)), (std::vector{cellAt(4, 2)}));
    EXPECT_EQ(tried(squareCover(), shader::kCoverWhole), std::vector<uint32_t>());
}

// A point that does not lie in the middle has other cells near by.
TEST(StepAside, TriesCellsFromWhereThePointIs) {
    shader::PatchCover cover = squareCover();
    cover.place = shader::kCoverPlaces / 10 | shader::kCoverPlaces / 10 << 16;
    EXPECT_EQ(tried(cover, shader::kCoverCells), (std::vector{cellAt(0, 0), cellAt(4, 4)}));
}

TEST(StepAside, TellsWhichPointsAreOthers) {
    const std::vector before = {pointAt(1, 0), pointAt(3, 0), pointAt(4, 0), pointAt(7, 0)};
    const std::vector now = {pointAt(1, 0), pointAt(2, 0), pointAt(4, 1), pointAt(9, 0)};
    const OtherPoints others = otherPoints(before, now);
    EXPECT_EQ(others.points, (std::vector<uint32_t>{2, 3, 4, 7, 9}));
    EXPECT_EQ(others.senders, (std::vector<uint32_t>{2, 3, 7, 9}));
    EXPECT_TRUE(otherPoints(now, now).points.empty());
    EXPECT_EQ(otherPoints({}, now).senders.size(), 4u);
}

TEST(StepAside, BackIsWhereItWas) {
    PatchSet patches;
    patches.scene.patches.resize(2);
    patches.covers = {squareCover(), squareCover()};
    const OwnPoint home{.patch = 1, .position = {0, 5, 0}, .place = 7, .cells = 3};
    const OwnPoint aside{.patch = 1, .position = {1, 5, 0}, .place = 8, .cells = 4, .sends = true};
    patches.aside = {home};
    patches.scene.patches[1].position = aside.position;
    patches.scene.patches[1].flags = shader::kPatchSends;
    patches.covers[1].place = aside.place;
    patches.covers[1].cells = aside.cells;
    EXPECT_EQ(stepBack(patches), std::vector{aside});
    EXPECT_TRUE(patches.aside.empty());
    EXPECT_EQ(patches.scene.patches[1].position, home.position);
    EXPECT_EQ(patches.scene.patches[1].flags & shader::kPatchSends, 0u);
    EXPECT_EQ(patches.covers[1].place, home.place);
    EXPECT_EQ(patches.covers[1].cells, home.cells);
    EXPECT_TRUE(stepBack(patches).empty());
}

// What lay upon a surface sends from home, too, and is not counted among what lies inside something.
TEST(StepAside, WhatSentBeforeSendsAgain) {
    PatchSet patches;
    patches.scene.patches.resize(2);
    patches.covers = {squareCover(), squareCover()};
    patches.aside = {{.patch = 0, .position = {}, .place = 7, .cells = 3, .sends = true},
                     {.patch = 1, .position = {}, .place = 7, .cells = 3}};
    for (shader::Patch& patch : patches.scene.patches)
        patch.flags = shader::kPatchSends;
    EXPECT_EQ(asideFromInside(patches), 1u);
    stepBack(patches);
    EXPECT_NE(patches.scene.patches[0].flags & shader::kPatchSends, 0u);
    EXPECT_EQ(patches.scene.patches[1].flags & shader::kPatchSends, 0u);
}

} // namespace relume
