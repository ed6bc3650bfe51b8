// What several processes may share, and what ends them.
#include "app/offline/rank_work.h"
#include "assets/base/error.h"
#include "tests/unit/thread_ranks.h"

#include <gtest/gtest.h>

#include <atomic>

namespace relume {
namespace {

BakeRequest sharedRequest(Method method) {
    BakeRequest request;
    request.bake.solver.method = method;
    return request;
}

TEST(SharedBake, HybridAndDirectionalAreShared) {
    for (const Method method : {Method::Hybrid, Method::Directional})
        EXPECT_NO_THROW(checkSharedBake(sharedRequest(method), 4));
}

TEST(SharedBake, WhatCannotBeSharedIsWrongUsageForSeveralOnly) {
    BakeRequest layers = sharedRequest(Method::Hybrid), coarse = layers;
    layers.bake.solver.layers.on = true;
    coarse.bake.solver.links.indirectScale = 2;
    for (const BakeRequest& request : {sharedRequest(Method::Pure), layers, coarse}) {
        EXPECT_NO_THROW(checkSharedBake(request, 1));
        EXPECT_THROW(checkSharedBake(request, 2), UsageError);
    }
}

TEST(SharedBake, AProcessThatNobodyLaunchedWorksAlone) {
    uint32_t times = 0;
    runOnRanks({}, [&](Ranks& ranks) {
        EXPECT_TRUE(ranks.alone());
        ++times;
    });
    EXPECT_EQ(times, 1u);
    EXPECT_THROW(runOnRanks({}, [](Ranks&) { throw UsageError("wrong"); }), UsageError);
}

TEST(SharedBake, AllLearnThatOneIsUnlikeTheOthers) {
    std::atomic<uint32_t> refused = 0;
    runThreadRanks(3, [&](Ranks& ranks) {
        EXPECT_NO_THROW(requireAlike(ranks, "the same"));
        try {
            requireAlike(ranks, ranks.rank() == 2 ? "on 'Card B'" : "on 'Card A'");
        } catch (const Error& error) {
            const std::string what = error.what();
            EXPECT_NE(what.find("process 2 bakes on 'Card B', process 0 on 'Card A'"), std::string::npos)
                << what;
            ++refused;
        }
    });
    EXPECT_EQ(refused, 3u);
}

} // namespace
} // namespace relume
