// What several processes may share, and what ends them.
#include "app/offline/layer_ranks.h"
#include "app/offline/rank_work.h"
#include "assets/base/error.h"
#include "tests/unit/ranks/thread_ranks.h"

#include <gtest/gtest.h>

#include <atomic>

namespace relume {
namespace {

BakeRequest sharedRequest(Method method) {
    BakeRequest request;
    request.bake.solver.method = method;
    return request;
}

TEST(SharedBake, EveryMethodIsShared) {
    for (const Method method : {Method::Hybrid, Method::Directional, Method::Pure, Method::Static,
                                Method::MonteCarlo, Method::Mipmapped, Method::Adaptive})
        EXPECT_NO_THROW(checkSharedBake({}, sharedRequest(method), 4));
}

TEST(SharedBake, WhatCannotBeSharedIsWrongUsageForSeveralOnly) {
    BakeRequest coarse = sharedRequest(Method::Hybrid);
    coarse.bake.solver.links.indirectScale = 2;
    EXPECT_NO_THROW(checkSharedBake({}, coarse, 1));
    EXPECT_THROW(checkSharedBake({}, coarse, 2), UsageError);
}

TEST(SharedBake, LayersAreSharedWhereEachStopsByItself) {
    BakeRequest request = sharedRequest(Method::Hybrid);
    request.bake.solver.layers.on = true;
    EXPECT_NO_THROW(checkSharedBake({}, request, 1));
    EXPECT_THROW(checkSharedBake({}, request, 2), UsageError); // by the error of all together
    request.bake.solver.links.samples = 64;
    EXPECT_THROW(checkSharedBake({}, request, 2), UsageError);
    request.bake.solver.error = 0;
    EXPECT_NO_THROW(checkSharedBake({}, request, 2));
    BakeOptions options;
    options.files.json = "statistics.json";
    EXPECT_NO_THROW(checkSharedBake(options, request, 1));
    EXPECT_THROW(checkSharedBake(options, request, 2), UsageError);
}

TEST(SharedBake, LightsAreDealtInTurn) {
    const std::vector<std::string> lights = {"a", "b", "c", "d", "e"};
    EXPECT_EQ(dealtLights(lights, 0, 2), (std::vector<std::string>{"a", "c", "e"}));
    EXPECT_EQ(dealtLights(lights, 1, 2), (std::vector<std::string>{"b", "d"}));
    EXPECT_TRUE(dealtLights(lights, 6, 7).empty());
    EXPECT_EQ(dealtLights(lights, 0, 1), lights);
}

TEST(SharedBake, LayersOnTheirWayKeepEveryBit) {
    LayeredImage image;
    image.composite.width = 2;
    image.composite.height = 1;
    image.composite.add("R") = {1.5f, -0.0f};
    image.composite.attributes["relume:passes"] = "7";
    LayeredImage::Layer& layer = image.layers.emplace_back();
    layer.name = "Lamp, left";
    layer.weight = {0.1f, 2.0f, 1e-30f};
    layer.attributes["relume:estimate"] = std::string(10000, '1');
    layer.image.width = 2;
    layer.image.height = 1;
    layer.image.add("G") = {3.0e-39f, 4.0f};
    const std::vector<std::byte> bytes = packedLayers(image);
    const LayeredImage back = unpackedLayers(bytes);
    EXPECT_EQ(packedLayers(back), bytes);
    ASSERT_EQ(back.layers.size(), 1u);
    EXPECT_EQ(back.layers[0].name, layer.name);
    EXPECT_EQ(back.layers[0].weight, layer.weight);
    EXPECT_EQ(back.layers[0].attributes, layer.attributes);
    EXPECT_EQ(back.layers[0].image.planes, layer.image.planes);
    EXPECT_EQ(back.composite.channels, image.composite.channels);
    EXPECT_EQ(back.composite.attributes, image.composite.attributes);
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
