// The lights of a live bake: the first that is seen of them, and a layer for each.
#include "app/live/layer_remark.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/live/live_bake_fixture.h"
#include "tests/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

namespace relume {
namespace {

TEST_F(LiveBakeTest, WhatIsSeenFirstHasTheLightOfAllLamps) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    for (int i = 0; i < 3; ++i) {
        edits_.lights.push_back({.name = "Bulb " + std::to_string(i)});
        edits_.lights.back().transform[3] = glm::vec4(0.1f * static_cast<float>(i), 1.4f, 0.4f, 1.0f);
    }
    struct Seen {
        double mean;
        bool complete;
    };
    std::vector<Seen> maps;
    onMap_ = [&] { maps.push_back({screen_.mean(), screen_.map()->complete}); };
    start(settings, false);
    ASSERT_TRUE(untilShown());
    const double end = screen_.mean();
    ASSERT_GE(maps.size(), 2u);
    EXPECT_FALSE(maps.front().complete) << "direct light comes before it has bounced";
    for (const Seen& map : maps) {
        EXPECT_GT(map.mean, software_ ? 0.3 * end : 0.0) << "a CPU shows all lights at a first glance";
        EXPECT_LT(map.mean, 1.1 * end);
    }
    EXPECT_TRUE(std::is_sorted(maps.begin(), maps.end(), [](const Seen& a, const Seen& b) {
        return a.complete < b.complete;
    })) << "what was complete stays so";
}

TEST_F(LiveBakeTest, WhatWasSeenFirstChangesNoByteOfTheEnd) {
    const TemporaryFolder folder;
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(untilPhase(BakeStatus::Phase::Done));
    bake_.exportLightmap({.path = folder.path("live.exr"), .lightmap = {}, .scene = "scene.glb"});
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("live.exr")); }));
    Baker baker(testDevice(), scene_.scene, scene_.mesh, settings);
    while (!baker.solver().done())
        baker.solver().step();
    EXPECT_EQ(readImage(folder.path("live.exr")).planes, baker.lightmap({}).planes);
}

TEST_F(LiveBakeTest, AnotherStartEndsAFirstGlance) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    for (int i = 0; i < 20; ++i) {
        start(settings, false);
        std::this_thread::yield();
    }
    ASSERT_TRUE(untilShown());
    EXPECT_TRUE(bake_.status().layered);
}

// A bake that begins again has the mix that it had.
TEST_F(LiveBakeTest, AMutedLightStaysDarkWhereTheBakeBeginsAgain) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    edits_.lights.push_back({.name = "Bulb"});
    edits_.lights.back().transform[3] = glm::vec4(0.0f, 1.4f, 0.4f, 1.0f);
    LightMix mix;
    mix.muted = {lightSources(scene_.scene).at(0).key}; // the bulb alone is left
    start(settings, false);
    ASSERT_TRUE(untilShown());
    const double all = screen_.mean();
    newest_ =
        bake_.start({.scene = &scene_, .edits = edits_, .mix = mix, .settings = settings, .keepLight = true});
    ASSERT_TRUE(untilShown());
    const double muted = screen_.mean();
    ASSERT_LT(muted, 0.75 * all);
    for (const bool shaders : {false, true}) {
        const uint64_t beginnings = bake_.status().beginnings;
        if (shaders)
            bake_.reloadShaders();
        else
            bake_.reset();
        ASSERT_TRUE(until([&] { return bake_.status().beginnings > beginnings; }));
        ASSERT_TRUE(untilShown());
        EXPECT_NEAR(screen_.mean(), muted, 0.05 * muted) << shaders;
    }
}

// Without a light nothing bounces, and what is shown may be of the same bake.
TEST_F(LiveBakeTest, TheOnlyLightGoesDarkWhereItIsMutedOrTakenAway) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(untilShown());
    ASSERT_GT(screen_.mean(), 0);
    const auto isDark = [&] { return screen_.map()->bake == newest_ && screen_.mean() == 0; };
    LightMix mix;
    for (const LightSource& source : lightSources(scene_.scene))
        mix.muted.push_back(source.key);
    newest_ =
        bake_.start({.scene = &scene_, .edits = edits_, .mix = mix, .settings = settings, .keepLight = true});
    EXPECT_TRUE(until(isDark)) << screen_.mean();
    start(settings);
    ASSERT_TRUE(until([&] { return screen_.map()->bake == newest_ && screen_.mean() > 0; }));
    for (Material& material : edits_.materials)
        material.emission = glm::vec3(0.0f);
    start(settings);
    EXPECT_TRUE(until(isDark)) << screen_.mean();
}

// A user edits a scene as soon as it is seen, while it is prepared.
TEST_F(LiveBakeTest, AnEditOfTheFirstPreparationHidesNoFirstLight) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(until([&] { return bake_.status().phase != BakeStatus::Phase::Idle; }));
    edits_.lights.push_back({.name = "Bulb"});
    start(settings);
    const bool early = bake_.status().phase == BakeStatus::Phase::Preparing;
    ASSERT_TRUE(until([&] { return screen_.map().has_value(); }));
    if (early) {
        EXPECT_FALSE(screen_.map()->complete) << "direct light comes before it has bounced";
    }
    ASSERT_TRUE(untilShown());
}

// The edit that waits for a rest is newer than what a step fails by, and takes it away.
TEST_F(LiveBakeTest, AnEditThatWaitsIsBakedAfterAStepThatFails) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(untilShown());
    const SceneEdits before = edits_;
    for (Material& material : edits_.materials)
        material.emission = glm::vec3(0.0f);
    edits_.lights.push_back({.name = "Bulb", .type = LightType::Spot});
    edits_.lights.back().transform[3] = glm::vec4(0.0f, 1.5f, 0.5f, 1.0f);
    edits_.lights.back().transform[2].x = std::numeric_limits<float>::quiet_NaN(); // so is its light
    bake_.setBatchMs(1);
    start(settings);
    bake_.pause();
    ASSERT_TRUE(untilPhase(BakeStatus::Phase::Paused));
    const double seconds = bake_.status().progress.seconds;
    bake_.step(); // into the bulb's layer
    ASSERT_TRUE(until([&] {
        const BakeStatus status = bake_.status();
        return status.progress.seconds > seconds && status.phase == BakeStatus::Phase::Paused;
    }));
    edits_ = before;
    edits_.placements.back().transform[3].x += 0.01f; // objects wait until the bake is at rest
    bake_.setBatchMs(8);
    testing::internal::CaptureStdout();
    start(settings);
    const bool shown = untilShown();
    const std::string told = testing::internal::GetCapturedStdout();
    ASSERT_TRUE(shown) << told;
    EXPECT_NE(told.find("too bright"), std::string::npos) << "no step failed: " << told;
}

TEST_F(LiveBakeTest, TellsALayerAtTexelsAndAloneAsAMap) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(untilShown());
    EXPECT_TRUE(bake_.status().layered);
    EXPECT_TRUE(bake_.status().stale.empty());
    const double whole = screen_.mean(); // of the only light
    const std::vector<LightSource> sources = lightSources(scene_.scene);
    ASSERT_EQ(sources.size(), 1u);
    InspectRequest alone{.content = MapContent::Layer, .light = sources[0].key, .weight = sources[0].weight};
    bake_.inspect(alone);
    const auto shows = [&](double factor) {
        return until([&] {
            return screen_.map()->content == MapContent::Layer &&
                   std::abs(screen_.mean() - factor * whole) < 1e-3 * whole;
        });
    };
    EXPECT_TRUE(shows(1)) << screen_.mean() << " for " << whole;
    alone.weight *= 3.0f;
    bake_.inspect(alone);
    EXPECT_TRUE(shows(3)) << "weighed anew, no bake";
    EXPECT_EQ(bake_.status().phase, BakeStatus::Phase::Done);

    const TemporaryFolder folder;
    bake_.exportLightmap({.path = folder.path("live.exr"), .lightmap = {}, .scene = "saved.glb"});
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("live.exr")); }));
    const FloatImage map = readImage(folder.path("live.exr"));
    EXPECT_EQ(map.attributes.at("relume:scene"), "saved.glb");
    std::vector<uint32_t> texels = {shader::kNoPatch};
    for (uint32_t texel = 0; texel < kQuickSize * kQuickSize; ++texel)
        if (map.find("coverage")->at(texel) == 1.0f) texels.push_back(texel);
    bake_.askProbes({.number = 7, .texels = texels});
    std::optional<LayerProbe> probe;
    ASSERT_TRUE(until([&] { return (probe = bake_.exchange().takeProbe()).has_value(); }));
    EXPECT_EQ(probe->request, 7u);
    EXPECT_EQ(probe->key, sources[0].key);
    ASSERT_EQ(probe->light.size(), texels.size());
    EXPECT_EQ(probe->light[0], glm::vec3(0));
    for (size_t i = 1; i < texels.size(); ++i)
        EXPECT_NEAR(probe->light[i].g * sources[0].weight.g, map.find("G")->at(texels[i]), 1e-4) << texels[i];
    EXPECT_FALSE(until([&] { return bake_.exchange().hasProbe(); }, 0.3)) << "told once";
}

TEST_F(LiveBakeTest, SaysWhyThereAreNoLayers) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    settings.solver.layers.bytes = 1;
    settings.solver.error = 0.2; // directional light takes long to become clean
    start(settings, false);
    ASSERT_TRUE(untilPhase(BakeStatus::Phase::Done));
    EXPECT_FALSE(bake_.status().layered);
    EXPECT_NE(bake_.status().remark.find("1 lights are baked as one"), std::string::npos)
        << bake_.status().remark;
    settings.solver.layers.bytes = 0;
    settings.solver.method = Method::Directional;
    start(settings, false);
    ASSERT_TRUE(untilPhase(BakeStatus::Phase::Done));
    EXPECT_NE(bake_.status().remark.find("choose hybrid"), std::string::npos) << bake_.status().remark;
    settings.solver.layers.on = false;
    start(settings, false);
    ASSERT_TRUE(untilPhase(BakeStatus::Phase::Done));
    EXPECT_EQ(bake_.status().remark, "");
}

TEST_F(LiveBakeTest, TellsWhichLightsShareALayer) {
    BakeSettings settings = quickSettings();
    start(settings, false);
    ASSERT_TRUE(untilPhase(BakeStatus::Phase::Done));
    EXPECT_TRUE(bake_.status().groups.empty());
    EXPECT_EQ(groupRemark({}), "");
    settings.solver.layers.on = true;
    // This is the memory of three layers or four: direct light and result, a vec4 per patch, and padding of
    // up to a quarter.
    settings.solver.layers.bytes = uint64_t{4} * 2 * sizeof(glm::vec4) * bake_.status().patches;
    for (int i = 0; i < 7; ++i) {
        edits_.lights.push_back({.name = "Bulb " + std::to_string(i)});
        edits_.lights.back().transform[3] = glm::vec4(0.1f * static_cast<float>(i), 1.4f, 0.4f, 1.0f);
    }
    start(settings);
    ASSERT_TRUE(untilShown());
    EXPECT_TRUE(bake_.status().layered);
    EXPECT_EQ(bake_.status().remark, "");
    const std::vector<LightGroup> groups = bake_.status().groups;
    ASSERT_EQ(groups.size(), 1u);
    EXPECT_EQ(groups[0].source.name, "rest");
    const LightKey last{LightKey::Kind::Lamp, 6, 0};
    EXPECT_EQ(groupWith(groups, last), &groups[0]);
    EXPECT_EQ(groupWith(groups, lightSources(scene_.scene)[0].key), nullptr) << "the first";
    EXPECT_NE(groupRemark(groups).find(std::to_string(groups[0].members.size()) + " lights"),
              std::string::npos)
        << groupRemark(groups);
    const double before = screen_.mean();
    const uint64_t bake = newest_;
    edits_.lights[6].intensity *= 4.0f;
    start(settings);
    ASSERT_GT(newest_, bake);
    ASSERT_TRUE(untilShown());
    EXPECT_GT(screen_.mean(), 1.001 * before);
    EXPECT_TRUE(bake_.status().stale.empty());
}

} // namespace
} // namespace relume
