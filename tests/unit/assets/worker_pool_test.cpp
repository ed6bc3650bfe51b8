#include "assets/base/worker_pool.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(WorkerPool, doesEverythingOnceHoweverOftenItIsUsed) {
    for (uint32_t threads : {1u, 2u, 7u}) {
        WorkerPool pool(threads);
        EXPECT_EQ(pool.size(), threads);
        for (uint32_t count : {0u, 1u, 2u, 1000u, 3u}) {
            std::vector<std::atomic<uint32_t>> done(count);
            pool.run(count, [&](uint32_t i) { ++done[i]; });
            for (const auto& times : done)
                EXPECT_EQ(times, 1u);
        }
    }
}

TEST(WorkerPool, theEnvironmentSaysHowManyThreadsThereAre) {
    const char* before = std::getenv("RELUME_THREADS");
    const std::string old = before ? before : "";
    setenv("RELUME_THREADS", "3", 1);
    EXPECT_EQ(WorkerPool::defaultSize(), 3u);
    EXPECT_EQ(WorkerPool(0).size(), 3u);
    for (const char* wrong : {"0", "-2", "many", ""}) {
        setenv("RELUME_THREADS", wrong, 1);
        EXPECT_EQ(WorkerPool::defaultSize(), std::max(1u, std::thread::hardware_concurrency())) << wrong;
    }
    before ? setenv("RELUME_THREADS", old.c_str(), 1) : unsetenv("RELUME_THREADS");
}

TEST(WorkerPool, loopsMayRunBesideEachOther) {
    WorkerPool pool(3);
    constexpr uint32_t kCallers = 4, kLoops = 200, kCount = 50;
    std::vector<uint64_t> sums(kCallers);
    std::vector<std::thread> callers;
    for (uint32_t caller = 0; caller < kCallers; ++caller) {
        callers.emplace_back([&, caller] {
            for (uint32_t loop = 0; loop < kLoops; ++loop) {
                std::vector<uint32_t> made(kCount);
                pool.run(kCount, [&](uint32_t i) { made[i] = caller + i; });
                for (const uint32_t value : made)
                    sums[caller] += value;
            }
        });
    }
    for (std::thread& thread : callers)
        thread.join();
    for (uint32_t caller = 0; caller < kCallers; ++caller)
        EXPECT_EQ(sums[caller], uint64_t{kLoops} * (kCount * caller + kCount * (kCount - 1) / 2));
}

TEST(WorkerPool, loopsMayRunWithinEachOther) {
    for (uint32_t threads : {1u, 2u, 5u}) {
        WorkerPool pool(threads);
        constexpr uint32_t kOuter = 20, kMiddle = 7, kInner = 9;
        std::vector<std::atomic<uint32_t>> done(kOuter * kMiddle * kInner);
        pool.run(kOuter, [&](uint32_t i) {
            pool.run(kMiddle, [&, i](uint32_t j) {
                pool.run(kInner, [&, i, j](uint32_t k) { ++done[(i * kMiddle + j) * kInner + k]; });
            });
        });
        for (const auto& times : done)
            EXPECT_EQ(times, 1u);
    }
}

TEST(WorkerPool, passesOnWhatTheWorkThrowsAndGoesOn) {
    for (uint32_t threads : {1u, 4u}) {
        WorkerPool pool(threads);
        const auto fail = [](uint32_t i) {
            if (i == 17) throw std::runtime_error("seventeen");
        };
        EXPECT_THROW(pool.run(100, fail), std::runtime_error);
        std::atomic<uint32_t> done = 0;
        pool.run(100, [&](uint32_t) { ++done; });
        EXPECT_EQ(done, 100u);
    }
}

} // namespace
} // namespace relume
