#include "app/viewer/state/fitting_text.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(FittingText, TheFirstTextThatFitsIsShown) {
    const std::vector<std::string> texts = {"error and local error", "error", "e"};
    const auto within = [](size_t most) {
        return [most](const std::string& text) { return text.size() <= most; };
    };
    EXPECT_EQ(firstThatFits(texts, within(100)), "error and local error");
    EXPECT_EQ(firstThatFits(texts, within(20)), "error");
    EXPECT_EQ(firstThatFits(texts, within(1)), "e");
    EXPECT_EQ(firstThatFits(texts, within(0)), "");
}

// In a window of 800 pixels, keys were cut off beside what they do.
TEST(FittingText, NoPairIsCutOffWhereOneFits) {
    const std::vector<PairWidth> pairs = {{50, 100}, {80, 150}, {60, 90}, {20, 200}};
    // The first column has 60 and 100, the second one 80 and 200; four gaps of 10.
    EXPECT_EQ(pairsInARow(pairs, 2, 10, 480), 2u);
    EXPECT_EQ(pairsInARow(pairs, 2, 10, 479), 1u);
    EXPECT_EQ(pairsInARow(pairs, 3, 10, 1000), 3u);
    EXPECT_EQ(pairsInARow(pairs, 2, 10, 1), 1u) << "nothing fits";
    EXPECT_EQ(pairsInARow({}, 2, 10, 100), 2u);
}

} // namespace
} // namespace relume
