#include "app/offline/lightmap_attributes.h"
#include "assets/generate/generate.h"
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/metrics.h"
#include "tests/gpu/relume_process.h"
#include "tests/live/live_bake_fixture.h"
#include "tests/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <thread>
#include <utility>

namespace relume {
namespace {

using namespace std::chrono_literals;

TEST_F(LiveBakeTest, EndsWithTheMapOfABakeWithoutAWindow) {
    const TemporaryFolder folder;
    const std::pair<Method, bool> bakes[] = {{Method::Hybrid, false},
                                             {Method::Hybrid, true},
                                             {Method::Directional, false},
                                             {Method::MonteCarlo, false}};
    for (const auto& [method, layers] : bakes) {
        BakeSettings settings = quickSettings();
        settings.solver.method = method;
        settings.solver.layers.on = layers;
        if (method == Method::Directional) settings.solver.error = 0.1; // it takes longest to become clean
        if (isPairMethod(method)) {
            settings.solver.pairs.window = 2;
            settings.solver.passes = 3;
            settings.solver.error = 0;
        }
        start(settings);
        // The camera sees a part of the scene only, and the budget changes all the time.
        bake_.setSeenTiles({5, 6, 7, 12, 13, 14, 40});
        double ms = 1;
        ASSERT_TRUE(until([&] {
            bake_.setBatchMs(ms = ms > 20 ? 1 : 1.3 * ms);
            return isIn(BakeStatus::Phase::Done);
        }));
        bake_.exportLightmap({.path = folder.path("live.exr"), .lightmap = {}, .scene = "scene.glb"});
        ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("live.exr")); }));

        const vk::Device& device = testDevice();
        Baker baker(device, scene_.scene, scene_.mesh, settings);
        while (!baker.solver().done())
            baker.solver().step();
        const FloatImage expected = baker.lightmap({}), got = readImage(folder.path("live.exr"));
        for (size_t c = 0; c < expected.planes.size(); ++c) {
            if (!isPairMethod(method)) {
                EXPECT_EQ(got.planes[c], expected.planes[c]) << methodName(method);
                continue;
            }
            double square = 0, sum = 0;
            for (size_t i = 0; i < expected.planes[c].size(); ++i) {
                square += std::pow(got.planes[c][i] - expected.planes[c][i], 2.0);
                sum += expected.planes[c][i];
            }
            const auto texels = static_cast<double>(expected.planes[c].size());
            EXPECT_LE(std::sqrt(square / texels), 1e-5 * sum / texels) << methodName(method);
        }
        std::filesystem::remove(folder.path("live.exr"));
    }
}

TEST_F(LiveBakeTest, AnEditOfLightsGoesOnWithTheSameBake) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(untilShown());
    const double before = screen_.mean();
    const uint64_t rays = bake_.status().progress.rays;
    ASSERT_GT(rays, 0u);
    for (Material& material : edits_.materials)
        material.emission *= 0.5f;
    start(settings);
    ASSERT_TRUE(untilShown());
    EXPECT_NEAR(screen_.mean(), 0.5 * before, 1e-3 * before);
    EXPECT_EQ(bake_.status().progress.rays, rays);
    edits_.lights.push_back({.name = "Bulb"});
    edits_.lights.back().transform[3] = glm::vec4(0.0f, 1.5f, 0.5f, 1.0f);
    start(settings);
    ASSERT_TRUE(untilShown());
    EXPECT_GT(screen_.mean(), 0.51 * before);
    EXPECT_GT(bake_.status().progress.rays, rays);
}

// The newest edit wins, nothing piles up, and the end is that of a bake of the last edit alone.
TEST_F(LiveBakeTest, AStormOfEditsEndsWithTheLastOne) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    // To the composite's error a layer would go as far as some mix on the way asked for, which may be
    // further.
    settings.solver.layers.error = std::exchange(settings.solver.error, 0.0);
    edits_.lights.push_back({.name = "Bulb"});
    start(settings, false);
    ASSERT_TRUE(untilShown());
    for (int i = 0; i < 300; ++i) {
        edits_.lights.back().transform[3] =
            glm::vec4(0.002f * static_cast<float>(i) - 0.3f, 1.4f, 0.4f, 1.0f);
        edits_.lights.back().intensity = 1.0f + 0.01f * static_cast<float>(i);
        start(settings);
        if (i % 3 == 0) until([] { return false; }, 0.005);
    }
    const auto last = Clock::now();
    ASSERT_TRUE(untilShown());
    EXPECT_LT(Clock::now() - last, 10s) << "what was superseded is not worked off";
    Scene scene = scene_.scene;
    applyEdits(scene, edits_);
    Baker baker(testDevice(), scene, scene_.mesh, settings);
    while (!baker.solver().done())
        baker.solver().step();
    const TemporaryFolder folder;
    bake_.exportLightmap({.path = folder.path("live.exr"), .lightmap = {}, .scene = "scene.glb"});
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("live.exr")); }));
    const FloatImage expected = baker.lightmap({}), got = readImage(folder.path("live.exr"));
    for (size_t c = 0; c < expected.planes.size(); ++c)
        EXPECT_EQ(got.planes[c], expected.planes[c]);
}

// A file that another program wrote anew, with a light moved: the bake goes on with that light alone.
TEST_F(LiveBakeTest, ASceneOfTheSameSurfacesIsAnEdit) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    edits_.lights.push_back({.name = "Bulb"});
    edits_.lights.back().transform[3] = glm::vec4(0.0f, 1.5f, 0.5f, 1.0f);
    start(settings, false);
    ASSERT_TRUE(untilShown());
    const uint64_t beginnings = bake_.status().beginnings, rays = bake_.status().progress.rays;
    const PreparedScene saved = cornell();
    edits_.lights.back().transform[3].x = 0.25f;
    newest_ = bake_.start({.scene = &saved, .edits = edits_, .settings = settings, .keepLight = true});
    ASSERT_TRUE(untilShown());
    EXPECT_EQ(bake_.status().beginnings, beginnings);
    EXPECT_GT(bake_.status().progress.rays, rays);
    EXPECT_FALSE(bake_.holds(saved)) << "it may go";

    const TemporaryFolder folder;
    bake_.exportLightmap({.path = folder.path("live.exr"), .lightmap = {}, .scene = "scene.glb"});
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("live.exr")); }));
    Scene scene = scene_.scene;
    applyEdits(scene, edits_);
    Baker baker(testDevice(), scene, scene_.mesh, settings);
    while (!baker.solver().done())
        baker.solver().step();
    const FloatImage expected = baker.lightmap({}), got = readImage(folder.path("live.exr"));
    EXPECT_LE(compareImages(got, "got", expected, "expected").relRmse, 2 * settings.solver.error);

    // Other surfaces of another level need another bake.
    newest_ = bake_.start(
        {.scene = &saved, .edits = edits_, .settings = settings, .keepLight = false, .surfaces = 2});
    ASSERT_TRUE(untilShown());
    EXPECT_GT(bake_.status().beginnings, beginnings);
}

// A file that another program wrote anew, with an object gone and other textures: the bake goes on, also
// where the next file comes while it is prepared, and what is shown never grows dark.
TEST_F(LiveBakeTest, AnEditedLevelGoesOnWithWhatStays) {
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    settings.solver.error = 0;
    settings.solver.links.samples = 64;
    start(settings, false);
    ASSERT_TRUE(untilShown());
    const uint64_t beginnings = bake_.status().beginnings, rays = bake_.status().progress.rays;
    const double lit = screen_.mean();
    double darkest = lit;
    onMap_ = [&] { darkest = std::min(darkest, screen_.mean()); };

    PreparedScene first = cornell();
    first.scene.materials.front().roughness *= 0.5f;
    PreparedScene saved = cornell();
    saved.scene.instances.pop_back();
    saved.atlas.instances.pop_back();
    saved.mesh = flatten(saved.scene, saved.atlas);
    uint64_t surfaces = 2;
    for (PreparedScene* scene : {&first, &saved}) {
        edits_ = editsOf(scene->scene);
        newest_ = bake_.start({.scene = scene,
                               .edits = edits_,
                               .settings = settings,
                               .keepLight = true,
                               .surfaces = surfaces++});
    }
    ASSERT_TRUE(untilShown());
    onMap_ = {};
    EXPECT_EQ(bake_.status().beginnings, beginnings);
    EXPECT_LT(bake_.status().progress.rays - rays, rays) << "than from the beginning";
    EXPECT_GT(darkest, 0.5 * lit);

    const TemporaryFolder folder;
    bake_.exportLightmap(
        {.path = folder.path("live.exr"), .lightmap = {}, .scene = "scene.glb", .surfaces = surfaces - 1});
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("live.exr")); }));
    Baker baker(testDevice(), saved.scene, saved.mesh, settings);
    while (!baker.solver().done())
        baker.solver().step();
    const FloatImage expected = baker.lightmap({}), got = readImage(folder.path("live.exr"));
    for (size_t c = 0; c < expected.planes.size(); ++c)
        EXPECT_EQ(got.planes[c], expected.planes[c]);
}

// An export comes with the edits that were made before it, and goes on where a newer edit comes between.
TEST_F(LiveBakeTest, AnEnginesLevelIsTheOneThatIsShown) {
    const TemporaryFolder folder;
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(untilShown());
    edits_.placements[0].transform[3] += glm::vec4(0.05f, 0.0f, 0.0f, 0.0f);
    edits_.materials[0].baseColor = {0.25f, 0.5f, 0.75f, 1.0f};
    Scene edited = scene_.scene;
    applyEdits(edited, edits_);
    start(settings);
    bake_.exportForEngine(
        {.desc = {.engine = Engine::Godot, .folder = folder.path("level"), .exposure = 1.0f},
         .scene = "scene.glb",
         .materials = edited.materials,
         .sky = {}});
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("level/level.tscn")); }));
    const Scene level = loadGltf(folder.path("level/scene.glb"));
    ASSERT_EQ(level.instances.size(), scene_.scene.instances.size());
    EXPECT_NEAR(level.instances[0].transform[3].x, edited.instances[0].transform[3].x, 1e-6f);
    EXPECT_TRUE(std::any_of(level.materials.begin(), level.materials.end(), [](const Material& material) {
        return material.baseColor == glm::vec4(0.25f, 0.5f, 0.75f, 1.0f);
    }));
    ASSERT_TRUE(untilPhase(BakeStatus::Phase::Done));

    // That of another scene is refused. Exports come one after another.
    const PreparedScene other = cornell();
    bake_.exportForEngine({.desc = {.folder = folder.path("other")},
                           .scene = "other.glb",
                           .surfaces = 2,
                           .materials = other.scene.materials,
                           .sky = {}});
    const BakeOrders::EngineExport same{.desc = {.folder = folder.path("same")},
                                        .scene = "scene.glb",
                                        .materials = edited.materials,
                                        .sky = {}};
    bake_.exportForEngine(same);
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("same/loader.js")); }));
    EXPECT_FALSE(std::filesystem::exists(folder.path("other")));
}

// An order may be given while its scene is prepared and another one is opened.
TEST_F(LiveBakeTest, ALightmapOfAnotherSceneIsNotWritten) {
    const TemporaryFolder folder;
    start(quickSettings(), false);
    ASSERT_TRUE(untilShown());
    bake_.exportLightmap(
        {.path = folder.path("other.exr"), .lightmap = {}, .scene = "other.glb", .surfaces = 2});
    bake_.exportLightmap({.path = folder.path("same.exr"), .lightmap = {}, .scene = "scene.glb"});
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("same.exr")); }));
    EXPECT_FALSE(std::filesystem::exists(folder.path("other.exr"))) << "exports come one after another";
}

// A page has the layers of the bake that is shown; without layers none is written, and the log says so.
TEST_F(LiveBakeTest, APageIsWrittenOfLayersAlone) {
    const TemporaryFolder folder;
    const auto order = [&](const char* name, bool page) {
        BakeOrders::EngineExport wanted;
        wanted.desc.folder = folder.path(name);
        if (page) wanted.web = WebDesc{.path = folder.path(name), .exposure = 1.0f, .frames = {}};
        wanted.scene = "scene.glb";
        wanted.materials = scene_.scene.materials;
        bake_.exportForEngine(wanted);
    };
    BakeSettings settings = quickSettings();
    start(settings, false);
    ASSERT_TRUE(untilShown());
    order("plain", true);
    order("after", false); // exports come one after another
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("after/loader.js")); }));
    EXPECT_FALSE(std::filesystem::exists(folder.path("plain")));
    settings.solver.layers.on = true;
    start(settings, false);
    ASSERT_TRUE(untilShown());
    order("layered", true);
    ASSERT_TRUE(until([&] { return std::filesystem::exists(folder.path("layered/index.html")); }));
}

TEST_F(LiveBakeTest, AnEditNeverLeavesTheRangeBetweenOldAndNew) {
    start(quickSettings(), false);
    ASSERT_TRUE(untilShown());
    const double before = screen_.mean();
    ASSERT_GT(before, 0);
    std::vector<double> means;
    onMap_ = [&] { means.push_back(screen_.mean()); };
    for (Material& material : edits_.materials)
        material.emission *= 0.5f;
    start(quickSettings());
    ASSERT_TRUE(untilShown());
    const double after = screen_.mean();
    EXPECT_NEAR(after, 0.5 * before, 0.03 * before);
    for (const double mean : means) {
        EXPECT_LE(mean, 1.02 * before);
        EXPECT_GE(mean, 0.98 * after);
    }
}

TEST_F(LiveBakeTest, AnotherMethodAndSizeKeepTheOldLightUntilTheirsIsThere) {
    start(quickSettings(), false);
    ASSERT_TRUE(untilShown());
    const double before = screen_.mean();
    std::vector<double> means;
    onMap_ = [&] { means.push_back(screen_.mean()); };
    BakeSettings settings = quickSettings();
    settings.solver.method = Method::MonteCarlo;
    settings.solver.pairs.window = 2;
    start(settings);
    ASSERT_TRUE(untilShown());
    settings.size = kQuickSize / 2;
    start(settings);
    ASSERT_TRUE(untilShown());
    start(quickSettings());
    ASSERT_TRUE(untilShown());
    // Windows of pixels as coarse as these miss the shares of small shadows; black would be far away.
    for (const double mean : means)
        EXPECT_NEAR(mean, before, 0.2 * before);
}

TEST_F(LiveBakeTest, PausesStepsPassesAbortsAndResets) {
    using Phase = BakeStatus::Phase;
    BakeSettings settings = quickSettings();
    settings.solver.error = software_ ? 0.002 : 0.001; // so long that all is seen in time
    start(settings, false);
    bake_.pause();
    ASSERT_TRUE(untilPhase(Phase::Paused));
    const double still = bake_.status().progress.seconds;
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(bake_.status().progress.seconds, still) << "it stands still";
    bake_.step();
    ASSERT_TRUE(until([&] { return bake_.status().progress.seconds > still; }));
    ASSERT_TRUE(untilPhase(Phase::Paused));
    // Hybrid's first pass is its direct light, which has no directions.
    while (bake_.status().progress.samples == 0) {
        const double before = bake_.status().progress.seconds;
        bake_.makePass();
        ASSERT_TRUE(until([&] {
            const BakeStatus status = bake_.status();
            return status.phase == Phase::Paused && status.progress.seconds > before;
        }));
    }
    const uint32_t samples = bake_.status().progress.samples;
    bake_.resume();
    ASSERT_TRUE(until([&] { return bake_.status().progress.samples > samples; }));
    bake_.abortPass();
    ASSERT_TRUE(untilPhase(Phase::Paused));
    bake_.resume();
    ASSERT_TRUE(untilPhase(Phase::Done));
    const double error = bake_.status().progress.error;
    EXPECT_LE(error, settings.solver.error);
    bake_.reset();
    ASSERT_TRUE(until([&] { return bake_.status().phase == Phase::Baking; }));
    ASSERT_TRUE(untilPhase(Phase::Done));
    EXPECT_EQ(bake_.status().progress.error, error) << "the same bake again";
}

TEST_F(LiveBakeTest, ShowsWhatIsInspectedAndTheLightAgain) {
    start(quickSettings(), false);
    ASSERT_TRUE(untilShown());
    const double light = screen_.mean();
    for (const MapContent content :
         {MapContent::LigIn, MapContent::LigOut, MapContent::Position, MapContent::Normal,
          MapContent::Material, MapContent::Area, MapContent::Leaves, MapContent::Error, MapContent::Seen}) {
        bake_.inspect({.content = content, .texel = kQuickSize * kQuickSize / 2 + kQuickSize / 2});
        EXPECT_TRUE(until([&] { return screen_.map()->content == content; })) << static_cast<int>(content);
    }
    EXPECT_TRUE(until([&] { return bake_.takePaths().has_value(); }));
    bake_.askVoxels(32);
    std::optional<InspectVoxels> voxels;
    EXPECT_TRUE(until([&] { return (voxels = bake_.takeVoxels()).has_value(); }));
    EXPECT_FALSE(voxels->centres.empty());
    bake_.inspect({});
    ASSERT_TRUE(until([&] { return screen_.map()->content == MapContent::Light; }));
    EXPECT_EQ(screen_.mean(), light);
}

TEST_F(LiveBakeTest, WhatCannotBeBakedIsToldAndTheNextBakeRuns) {
    BakeSettings settings = quickSettings();
    start(settings, false);
    ASSERT_TRUE(untilShown());
    const double light = screen_.mean();
    settings.size = 2 * Baker::kMaxSize;
    start(settings);
    ASSERT_TRUE(until([&] { return bake_.status().phase == BakeStatus::Phase::Failed; }));
    EXPECT_FALSE(bake_.status().doing.empty());
    EXPECT_EQ(screen_.mean(), light) << "what was shown stays";
    start(quickSettings());
    ASSERT_TRUE(untilShown());
}

TEST_F(LiveBakeTest, EndsSoonWhateverItDoes) {
    const PreparedScene statue = prepareScene(
        {.path = std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_statue.glb", .size = 512});
    BakeSettings settings = quickSettings();
    settings.size = 512;
    newest_ = bake_.start({.scene = &statue, .edits = editsOf(statue.scene), .settings = settings});
    ASSERT_TRUE(until([&] { return bake_.status().phase == BakeStatus::Phase::Preparing; }));
    const auto start = Clock::now();
    bake_.stop();
    EXPECT_LT(Clock::now() - start, 10s); // 1 s where nothing else runs
}

} // namespace
} // namespace relume
