#include "bake/validity/met_bits.h"

#include "bake/base/shader_types.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

constexpr uint32_t kFront = 7; // a patch
constexpr uint32_t kSkyLink = shader::kLinkSky;

// Returns the bits of a patch whose first directions meet backs, the next ones the sky and the rest fronts.
MetBits metInOrder(uint32_t backs, uint32_t sky, uint32_t followed = kInsideDirections) {
    MetBits met;
    for (uint32_t k = 0; k < followed; ++k)
        met.note(k, k < backs ? shader::kLinkBack : k < backs + sky ? kSkyLink : kFront);
    return met;
}

} // namespace

TEST(MetBits, SayNothingBeforeTheFirstDirectionsAreFollowed) {
    EXPECT_EQ(insideBy(MetBits{}), Inside::Unknown);
    EXPECT_EQ(insideBy(metInOrder(0, 0, kFirstDirections - 1)), Inside::Unknown);
    EXPECT_EQ(insideBy(metInOrder(0, 0, kFirstDirections)), Inside::No) << "none of them meets a back";
    EXPECT_EQ(insideBy(metInOrder(1, 0, kFirstDirections)), Inside::Unknown);
}

TEST(MetBits, WhatIsNotedLastCounts) {
    MetBits met = metInOrder(0, 0);
    met.note(3, shader::kLinkBack);
    EXPECT_EQ(met.backs, 8u);
    met.note(3, kSkyLink);
    EXPECT_EQ(met.backs, 0u);
    EXPECT_EQ(met.sky, 8u);
    met.note(3, kFront);
    EXPECT_EQ(met, metInOrder(0, 0));
}

TEST(MetBits, TwoInFiveBacksAndMoreBacksThanFrontsAreInside) {
    EXPECT_EQ(insideBy(metInOrder(13, 19)), Inside::Yes) << "under a floor, below the sky";
    EXPECT_EQ(insideBy(metInOrder(12, 20)), Inside::No);
    EXPECT_EQ(insideBy(metInOrder(16, 0)), Inside::No) << "as many fronts";
    EXPECT_EQ(insideBy(metInOrder(17, 0)), Inside::Yes);
    EXPECT_EQ(insideBy(metInOrder(17, 0, 17)), Inside::Yes) << "whatever the others meet";
    EXPECT_EQ(insideBy(metInOrder(1, 0, 22)), Inside::No) << "whatever the others meet";
}

TEST(MetBits, TwoOfTheFirstDirectionsTellWhatMayTouchASurface) {
    EXPECT_TRUE(mayTouch(metInOrder(16, 0))) << "a half of them begins inside";
    EXPECT_TRUE(mayTouch(metInOrder(1, 0))) << "a quarter of them begins inside, at a corner";
    EXPECT_FALSE(mayTouch(metInOrder(0, 0)));
    EXPECT_FALSE(mayTouch(metInOrder(17, 0))) << "it lies inside";
    EXPECT_FALSE(mayTouch(metInOrder(2, 0, kFirstDirections - 1))) << "nobody knows yet";
    EXPECT_FALSE(mayTouch(MetBits{}));
}

// A search stops where more directions could not change what is told.
TEST(MetBits, WhatIsToldStaysToldWhateverElseIsFollowed) {
    std::mt19937 random(1);
    uint32_t told = 0;
    for (int run = 0; run < 20000; ++run) {
        const uint32_t backs = random() % 100, sky = backs + random() % (101 - backs); // percent
        MetBits met, whole;
        const uint32_t followed = kFirstDirections * (1 + random() % 4);
        for (uint32_t k = 0; k < kInsideDirections; ++k) {
            const uint32_t draw = random() % 100;
            const uint32_t link = draw < backs ? shader::kLinkBack : draw < sky ? kSkyLink : kFront;
            whole.note(k, link);
            if (k < followed) met.note(k, link);
        }
        ASSERT_NE(insideBy(whole), Inside::Unknown);
        if (insideBy(met) == Inside::Unknown) continue;
        told += followed < kInsideDirections;
        ASSERT_EQ(insideBy(met), insideBy(whole));
    }
    EXPECT_GT(told, 4000u);
}

} // namespace relume
