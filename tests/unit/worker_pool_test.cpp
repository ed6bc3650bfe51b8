#include "bake/base/worker_pool.h"

#include <atomic>

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

} // namespace
} // namespace relume
