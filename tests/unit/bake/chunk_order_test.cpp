#include "bake/base/chunk_order.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

using Ranges = std::vector<ChunkRange>;
constexpr uint32_t kAll = 1000; // more than there are

std::vector<uint8_t> bytes(uint32_t count, const Ranges& seen) {
    std::vector<uint8_t> result(count, 0);
    for (const ChunkRange& range : seen)
        std::fill_n(result.begin() + range.first, range.count, uint8_t{1});
    return result;
}

Ranges inOrder(ChunkOrder& order, uint32_t most, uint32_t gap) {
    Ranges ranges;
    while (order.left() > 0) {
        ranges.push_back(order.next(most, gap));
        order.finish(ranges.back());
    }
    return ranges;
}

} // namespace

TEST(ChunkOrder, WithoutPreferencesFromTheFirstToTheLast) {
    ChunkOrder order(20);
    EXPECT_EQ(order.next(kAll, 0), ChunkRange{});
    order.begin(10, {});
    EXPECT_EQ(order.count(), 10u);
    EXPECT_EQ(inOrder(order, 4, 2), (Ranges{{0, 4}, {4, 3}, {7, 3}}));
    EXPECT_EQ(order.next(kAll, 0), ChunkRange{});
    order.begin(12, {});
    EXPECT_EQ(inOrder(order, 4, 2), (Ranges{{0, 4}, {4, 4}, {8, 4}}));
    order.begin(20, {});
    EXPECT_EQ(inOrder(order, kAll, 0), (Ranges{{0, 20}}));
}

TEST(ChunkOrder, SeenOnesComeFirstWithSmallGaps) {
    const std::vector<uint8_t> seen = bytes(20, {{3, 2}, {7, 2}, {14, 1}});
    ChunkOrder order(20);
    order.begin(20, seen);
    EXPECT_EQ(inOrder(order, kAll, 0), (Ranges{{3, 2}, {7, 2}, {14, 1}, {0, 3}, {5, 2}, {9, 5}, {15, 5}}));
    order.begin(20, seen);
    EXPECT_EQ(inOrder(order, kAll, 2), (Ranges{{3, 6}, {14, 1}, {0, 3}, {9, 5}, {15, 5}}));
    order.begin(20, seen);
    EXPECT_EQ(order.next(3, 2), (ChunkRange{3, 2})); // never ends within a gap
    EXPECT_EQ(order.next(5, 2), (ChunkRange{3, 5}));
    order.finish({5, 1});
    EXPECT_EQ(order.next(kAll, 9), (ChunkRange{3, 2})); // nor goes on over what is done
}

TEST(ChunkOrder, OnesAreTakenWhereverTheyAre) {
    using Ones = std::vector<uint32_t>;
    ChunkOrder order(20);
    EXPECT_EQ(order.nextOnes(kAll), Ones{});
    order.beginMarked(bytes(20, {{1, 2}, {6, 1}, {9, 3}}), {});
    EXPECT_EQ(order.nextOnes(4), (Ones{1, 2, 6, 9}));
    order.finish(order.nextOnes(4));
    EXPECT_EQ(order.left(), 2u);
    EXPECT_EQ(order.nextOnes(4), (Ones{10, 11}));
    order.beginMarked(bytes(20, {{1, 2}, {6, 1}, {9, 3}}), bytes(20, {{2, 8}}));
    EXPECT_EQ(order.nextOnes(kAll), (Ones{2, 6, 9})) << "seen ones alone";
    order.finish(order.nextOnes(kAll));
    EXPECT_FALSE(order.prefersSome());
    EXPECT_EQ(order.nextOnes(kAll), (Ones{1, 10, 11}));
}

TEST(ChunkOrder, ANewLookAndARestoreKeepWhatIsDone) {
    ChunkOrder order(20);
    order.begin(12, bytes(12, {{8, 4}}));
    order.finish(order.next(2, 0));
    order.prefer(bytes(12, {{2, 1}, {8, 1}}));
    EXPECT_EQ(order.left(), 10u);
    EXPECT_FALSE(order.isLeft(8));
    EXPECT_EQ(order.next(kAll, 0), (ChunkRange{2, 1}));
    ChunkOrder other(20);
    other.marks() = order.marks();
    other.restore(12, {});
    EXPECT_EQ(inOrder(other, kAll, 0), (Ranges{{0, 8}, {10, 2}}));
}

TEST(ChunkOrder, EveryChunkComesOnce) {
    std::mt19937 random(7);
    for (int run = 0; run < 50; ++run) {
        const uint32_t count = 1 + random() % 200;
        const auto look = [&] {
            std::vector<uint8_t> seen(count);
            for (uint8_t& s : seen)
                s = random() % 3 == 0;
            return seen;
        };
        ChunkOrder order(256);
        order.begin(count, look());
        std::vector<uint32_t> times(count, 0);
        while (order.left() > 0) {
            const ChunkRange range = order.next(1 + random() % 9, random() % 4);
            ASSERT_GT(range.count, 0u);
            for (uint32_t k = 0; k < range.count; ++k)
                ++times.at(range.first + k);
            order.finish(range);
            if (random() % 4 == 0) order.prefer(random() % 5 == 0 ? std::vector<uint8_t>{} : look());
        }
        EXPECT_EQ(times, std::vector<uint32_t>(count, 1));
    }
}

TEST(ChunkOrder, RangesAreMerged) {
    EXPECT_EQ(merged({}), Ranges{});
    EXPECT_EQ(merged({{5, 2}, {0, 1}, {7, 1}, {6, 1}, {1, 2}, {10, 3}}), (Ranges{{0, 3}, {5, 3}, {10, 3}}));
}

} // namespace relume
