#include "assets/base/portions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

TEST(Portions, EachNumberComesOnce) {
    WorkerPool pool(3);
    for (const size_t count : {size_t{0}, size_t{1}, size_t{7}, size_t{8}, size_t{1000}}) {
        std::vector<uint32_t> times(count, 0);
        runPortions(pool, count, 8, [&](size_t begin, size_t end) {
            EXPECT_LE(end - begin, 8u);
            for (size_t i = begin; i < end; ++i)
                ++times[i];
        });
        EXPECT_EQ(times, std::vector<uint32_t>(count, 1)) << count;
    }
}

TEST(Portions, NumbersAreFoundInTheirOrder) {
    WorkerPool pool(3);
    constexpr size_t kCount = 300'001; // more than four portions
    const auto takes = [](size_t i) { return i % 7 == 3 || i > 299'000; };
    std::vector<uint32_t> expected;
    for (uint32_t i = 0; i < kCount; ++i)
        if (takes(i)) expected.push_back(i);
    EXPECT_EQ(numbersWhere(pool, kCount, takes), expected);
    EXPECT_TRUE(numbersWhere(pool, 0, takes).empty());
    EXPECT_TRUE(numbersWhere(pool, kCount, [](size_t) { return false; }).empty());
}

TEST(Portions, SumsRoundAlikeOnAnyNumberOfThreads) {
    constexpr size_t kCount = 300'001;
    const auto term = [](size_t i) { return 1.0 / static_cast<double>(i + 1); };
    WorkerPool one(1), three(3);
    const double sum = sumOverAll(one, kCount, term);
    EXPECT_EQ(sumOverAll(three, kCount, term), sum);
    EXPECT_NEAR(sum, std::log(double{kCount}) + 0.5772156649 + 0.5 / kCount, 1e-9); // the harmonic series
    EXPECT_EQ(sumOverAll(three, 0, term), 0.0);
}

} // namespace
} // namespace relume
