#include "bake/base/batch_rate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace relume {
namespace {

constexpr double kAimMs = 20;

// Runs batches of at most so many chunks on a device that takes `ms` for them and returns the size and the
// time of the last.
struct Batch {
    double chunks = 0, ms = 0;
};
Batch settle(BatchRate& rate, const std::function<double(double)>& ms, double aim = kAimMs, double most = 1e9,
             int batches = 60) {
    Batch last;
    for (int i = 0; i < batches; ++i) {
        last.chunks = std::clamp(std::floor(rate.wanted(aim)), 1.0, most);
        last.ms = ms(last.chunks);
        rate.note(last.chunks, aim, last.ms / 1000);
    }
    return last;
}

TEST(BatchRate, ReachesTheAimWhereTimeIsProportional) {
    for (const bool wide : {false, true})
        for (const double perChunk : {0.002, 0.1, 3.0}) {
            BatchRate rate(wide);
            const Batch last = settle(rate, [&](double n) { return perChunk * n; });
            EXPECT_NEAR(last.ms, kAimMs, 0.1 * kAimMs + perChunk) << wide << ' ' << perChunk;
            EXPECT_NEAR(rate.perMs(), 1 / perChunk, 0.05 / perChunk) << wide;
        }
}

// A batch that does not fill the device takes a fixed time: it must not shrink to nothing in search of
// a shorter one.
TEST(BatchRate, FillsADeviceWhoseLatencyExceedsTheAim) {
    for (const double aim : {5.0, 20.0, 45.0})
        for (const double latency : {1.0, 10.0, 25.0, 60.0}) {
            BatchRate rate(true);
            const double perChunk = 0.004;
            const Batch last = settle(
                rate, [&](double n) { return latency + perChunk * n; }, aim);
            const double speed = last.chunks / last.ms * perChunk; // of a device that is full
            EXPECT_GE(speed, 0.4) << aim << ' ' << latency;
            EXPECT_LE(last.ms, std::max(1.3 * aim, 3 * latency)) << aim << ' ' << latency;
        }
}

TEST(BatchRate, AMapThatIsOneBatchStaysOne) {
    BatchRate rate(true);
    const double most = 1541;
    const Batch last = settle(
        rate, [](double n) { return std::max(25.0, 0.004 * n); }, kAimMs, most);
    EXPECT_EQ(last.chunks, most);
}

// The rest of a pass is a short batch.
TEST(BatchRate, RestsOfPassesDoNotShrinkWhatFollows) {
    BatchRate rate(true);
    const auto ms = [](double n) { return std::max(25.0, 0.01 * n); };
    for (int pass = 0; pass < 30; ++pass)
        for (double left = 6000; left > 0;) {
            const double n = std::clamp(std::floor(rate.wanted(kAimMs)), 1.0, left);
            rate.note(n, kAimMs, ms(n) / 1000);
            left -= n;
        }
    EXPECT_GE(rate.wanted(kAimMs), 1500);
}

TEST(BatchRate, AFirstBatchThatCompilesShadersIsForgotten) {
    for (const bool wide : {false, true}) {
        BatchRate rate(wide);
        rate.note(rate.wanted(kAimMs), kAimMs, 0.5);
        const Batch last = settle(
            rate, [](double n) { return 0.01 * n; }, kAimMs, 1e9, 12);
        EXPECT_NEAR(last.ms, kAimMs, 0.2 * kAimMs) << wide;
    }
}

// Chunks cost up to three times as much as others: no batch takes far longer than the aim for long.
TEST(BatchRate, StaysNearTheAimWhereChunksDiffer) {
    BatchRate rate(true);
    int count = 0;
    double longest = 0, sum = 0;
    settle(
        rate,
        [&](double n) {
            const double ms = 0.02 * n * (1 + std::abs(std::sin(2.3 * ++count)));
            if (count > 20) longest = std::max(longest, ms);
            if (count > 20) sum += ms;
            return ms;
        },
        kAimMs, 1e9, 220);
    EXPECT_LT(longest, 5 * kAimMs);
    EXPECT_NEAR(sum / 200, kAimMs, 0.6 * kAimMs);
}

// Another level is opened or the camera moves: what was cheap becomes dear, and the other way round.
TEST(BatchRate, FollowsAChangeOfCost) {
    BatchRate rate(true);
    settle(rate, [](double n) { return 0.01 * n; });
    EXPECT_NEAR(settle(rate, [](double n) { return 0.2 * n; }).ms, kAimMs, 0.2 * kAimMs);
    EXPECT_NEAR(settle(rate, [](double n) { return 0.01 * n; }).ms, kAimMs, 0.2 * kAimMs);
}

} // namespace
} // namespace relume
