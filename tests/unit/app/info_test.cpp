#include "app/edit/scene_info.h"

#include "app/commands/command.h"
#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/uv_sets.h"
#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/glb_builder.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>

namespace relume {
namespace {

using nlohmann::json;

bool warns(const SceneInfo& info, const std::string& part) {
    return std::any_of(info.warnings.begin(), info.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

/// Runs one command line in this process and returns what it printed.
std::string run(const std::string& line) {
    CLI::App app;
    addInfoCommand(app);
    addUnwrapCommand(app);
    testing::internal::CaptureStdout();
    try {
        app.parse(line, false);
    } catch (...) {
        testing::internal::GetCapturedStdout();
        throw;
    }
    return testing::internal::GetCapturedStdout();
}

TEST(SceneInfo, CountsBoundsAndEmission) {
    Primitive lamp = test::square({0, 0}, {.5f, .5f}), wall = test::square({.5f, .5f}, {1, 1});
    lamp.material = 0;
    wall.material = 1;
    wall.indices.insert(wall.indices.end(), {0, 0, 1});
    Scene scene = test::sceneOf(lamp);
    test::addInstance(scene, test::addMesh(scene, wall), glm::scale(glm::mat4(1), glm::vec3(-3, 2, 1)));
    scene.materials.resize(2);
    scene.materials[0].emission = {1, 2, 3};
    scene.materials[0].doubleSided = true;
    scene.materials[0].name = "Lamp";
    scene.materials[1].alphaMode = AlphaMode::Mask;
    const SceneInfo info = inspectScene(scene, 100);
    EXPECT_EQ(info.triangles, 4u);
    EXPECT_EQ(info.maskedTriangles, 2u);
    EXPECT_EQ(info.droppedTriangles, 1u);
    EXPECT_EQ(info.low, glm::vec3(-3, 0, 0));
    EXPECT_EQ(info.high, glm::vec3(1, 2, 0));
    EXPECT_NEAR(info.area, 7.0, 1e-6);
    EXPECT_EQ(info.emitters, 1u);
    EXPECT_NEAR(info.emitterArea, 1.0, 1e-6);
    EXPECT_NEAR(info.emitted.b, 6.0, 1e-6); // both sides
    ASSERT_TRUE(info.mapped);
    EXPECT_EQ(info.charts, 2u);
    EXPECT_NEAR(info.statistics.coverage, 0.5, 1e-3);
    EXPECT_NEAR(info.statistics.texelDensityMax, 50.0, 1e-3);
    EXPECT_TRUE(warns(info, "material 'Lamp': double sided"));
    EXPECT_TRUE(warns(info, "1 triangles: have no area"));
    EXPECT_FALSE(warns(info, "bakes to black"));
}

// What light passes and what is hidden is left out of the bake, too, though there is nothing wrong with it.
TEST(SceneInfo, PanesAndHiddenObjectsAreNotCountedAsTrianglesWithoutArea) {
    Primitive wall = test::square({0, 0}, {.5f, .5f}), glass = test::square({.5f, .5f}, {1, 1});
    wall.material = 0;
    glass.material = 1;
    Scene scene = test::sceneOf(wall);
    test::addInstance(scene, test::addMesh(scene, glass));
    test::addInstance(scene, 0);
    scene.instances.back().hidden = true;
    scene.materials.resize(2);
    scene.materials[1].pane = true;
    const SceneInfo info = inspectScene(scene, 100);
    EXPECT_EQ(info.triangles, 2u);
    EXPECT_EQ(info.droppedTriangles, 0u);
    EXPECT_FALSE(warns(info, "have no area"));
}

TEST(SceneInfo, SceneWithoutLightOrUvsIsDescribedAllTheSame) {
    Scene scene = test::sceneOf(test::cube());
    const SceneInfo info = inspectScene(scene, 64);
    EXPECT_EQ(info.triangles, 12u);
    EXPECT_FALSE(info.mapped);
    EXPECT_EQ(info.charts, 0u);
    EXPECT_TRUE(warns(info, "no emitter, no light and no sky: it is lit by a preview light"));
    EXPECT_TRUE(warns(info, "leave out --no-unwrap"));
}

TEST(InfoCommand, JsonHoldsTheAtlasMapping) {
    test::GlbBuilder b = test::squareScene();
    b.node({{"mesh", 0}, {"name", "Second"}, {"translation", {0, 0, 5}}});
    const std::string path = b.write("info.glb");
    const json info = json::parse(run("info --json --size 64 " + path));
    EXPECT_EQ(info["triangles"], 4);
    EXPECT_EQ(info["instances"], 2);
    EXPECT_EQ(info["bounds"]["max"], json({1, 1, 5}));
    EXPECT_EQ(info["lightmap"]["repacked"], true);
    EXPECT_EQ(info["lightmap"]["instances"][1]["name"], "Second");
    EXPECT_EQ(info["lightmap"]["instances"][1]["texCoord"], 1);
    // Two squares of n texels and 2 between them fill 64, so n is 31 at most.
    EXPECT_NEAR(info["lightmap"]["instances"][0]["scale"][0].get<double>(), 31.0 / 64.0, 1e-6);
    const std::string table = run("info " + path);
    EXPECT_NE(table.find("repacked, a rectangle per instance"), std::string::npos);
    EXPECT_NE(table.find("density"), std::string::npos);
    EXPECT_THROW(run("info --size 0 " + path), CLI::ValidationError);
    EXPECT_THROW(run("info"), CLI::RequiredError);
}

TEST(SceneInfo, ASkyIsLightEnough) {
    Scene scene = test::sceneOf(test::cube());
    scene.sky.radiance = {0, 0, 1};
    EXPECT_FALSE(warns(inspectScene(scene, 64), "bakes to black"));
}

TEST(InfoCommand, ListsLightsByTypeAndTheSky) {
    Scene scene = test::sceneOf(test::square({0, 0}, {1, 1}));
    Light light;
    light.intensity = 2500;
    for (const char* name : {"Disc", "Panel", "Sun", "Spot", "Bulb", ""}) {
        light.name = name;
        light.type = static_cast<LightType>(std::abs(4 - static_cast<int>(scene.lights.size())));
        scene.lights.push_back(light);
    }
    scene.lights[0].radius = .15f;
    scene.lights[1].size = {1.2f, .3f};
    scene.lights[2].angle = .0093f;
    scene.lights[3].innerConeAngle = .25f;
    scene.lights[3].outerConeAngle = .5f;
    scene.lights[4].radius = .03f;
    scene.lights[4].range = 7;
    scene.lights[4].color = {1, .75f, .5f};
    scene.lights[4].transform[3] = {1, 2, 3, 1};
    scene.sky.radiance = {150, 170, 200};
    const std::string path = test::tempPath("lights.glb");
    saveGlb(scene, path);
    const std::string table = run("info " + path);
    const std::string expected =
        "lights      6: 1 point, 2 spot, 1 directional, 1 rectangle, 1 disc\n"
        "point       'Bulb', 2500 cd, colour (1, 0.75, 0.5), radius 0.03 m, range 7 m\n"
        "spot        'Spot', 2500 cd, colour (1, 1, 1), cone 14.32 to 28.65 degrees from the axis\n"
        "spot        2500 cd, colour (1, 1, 1), cone 0 to 45 degrees from the axis\n"
        "directional 'Sun', 2500 lux, colour (1, 1, 1), 0.5329 degrees across\n"
        "rectangle   'Panel', 2500 cd/m^2, colour (1, 1, 1), 1.2 x 0.3 m\n"
        "disc        'Disc', 2500 cd/m^2, colour (1, 1, 1), radius 0.15 m\n"
        "sky         (150, 170, 200) cd/m^2\n";
    EXPECT_NE(table.find(expected), std::string::npos) << table;

    const json info = json::parse(run("info --json " + path));
    ASSERT_EQ(info["lights"].size(), 6u); // in the file's order
    EXPECT_EQ(info["lights"][0]["type"], "disc");
    EXPECT_EQ(info["lights"][0]["unit"], "cd/m^2");
    EXPECT_EQ(info["lights"][0]["direction"], json({0, 0, -1}));
    EXPECT_FLOAT_EQ(info["lights"][1]["size"][0].get<float>(), 1.2f);
    EXPECT_NEAR(info["lights"][2]["angleDegrees"].get<double>(), .53285, 1e-4);
    EXPECT_NEAR(info["lights"][3]["coneDegrees"]["outer"].get<double>(), 28.6479, 1e-4);
    EXPECT_EQ(info["lights"][4]["name"], "Bulb");
    EXPECT_EQ(info["lights"][4]["intensity"], 2500);
    EXPECT_EQ(info["lights"][4]["range"], 7);
    EXPECT_EQ(info["lights"][4]["position"], json({1, 2, 3}));
    EXPECT_EQ(info["lights"][5]["range"], nullptr);
    EXPECT_EQ(info["sky"]["radiance"], json({150, 170, 200}));
    EXPECT_EQ(info["sky"]["picture"], nullptr);
}

TEST(InfoCommand, DescribesTheSkysPicture) {
    Scene scene = test::sceneOf(test::square({0, 0}, {1, 1}));
    const std::string path = test::tempPath("sky.glb");
    saveGlb(scene, path);
    EXPECT_NE(run("info " + path).find("sky         none\n"), std::string::npos);
    EXPECT_EQ(json::parse(run("info --json " + path))["sky"], nullptr);
    scene.sky.radiance = glm::vec3(2.0f);
    scene.sky.rotation = .5f;
    scene.sky.width = 4;
    scene.sky.height = 2;
    scene.sky.pixels.assign(8, glm::vec3(1.0f));
    saveGlb(scene, path);
    EXPECT_NE(run("info " + path).find("sky_sky.exr, 4 x 2, times (2, 2, 2), turned by 28.65 degrees\n"),
              std::string::npos);
    const json sky = json::parse(run("info --json " + path))["sky"];
    EXPECT_EQ(sky["picture"]["width"], 4);
    EXPECT_NEAR(sky["picture"]["rotationDegrees"].get<double>(), 28.6479, 1e-4);
}

TEST(UnwrapCommand, WritesASceneThatCanBeBaked) {
    test::GlbBuilder b;
    b.node({{"mesh", b.mesh(b.square(), "Bare")}});
    const std::string in = b.write("bare.glb"), out = test::tempPath("unwrapped.glb");
    EXPECT_THROW(buildAtlas(loadGltf(in), 64), Error);
    EXPECT_NE(run("unwrap " + in + " -o " + out + " --density 8")
                  .find("1 meshes unwrapped into 1 charts at 8 texels/m"),
              std::string::npos);
    const json made = json::parse(run("unwrap " + in + " -o " + out + " --json --size 100"));
    EXPECT_EQ(made["size"], 100);
    EXPECT_EQ(made["charts"], 1);
    // A square of 1 m gets 100 texels; a chart that is longer than the atlas is shortened by up to 15 %.
    EXPECT_GE(made["density"].get<double>(), 100.0);
    EXPECT_LE(made["density"].get<double>(), 115.0);
    EXPECT_NEAR(made["leastDensity"].get<double>(), 100.0, 1e-6);
    EXPECT_EQ(made["shortened"], made["density"].get<double>() > 100.5 ? 1 : 0);
    EXPECT_EQ(made["covered"], 1.0);
    EXPECT_NEAR(made["stretch"].get<double>(), 1.0, 1e-5);
    EXPECT_GE(made["seconds"].get<double>(), 0.0);
    const Scene scene = loadGltf(out);
    EXPECT_EQ(lightmapSet(scene.meshes.at(0)), 1);
    EXPECT_EQ(buildAtlas(scene, 64).instances.at(0).texCoord, 1);
    EXPECT_THROW(run("unwrap " + in + " -o out.png"), UsageError);
    EXPECT_THROW(run("unwrap " + in + " -o " + out + " --density -1"), CLI::ValidationError);
}

} // namespace
} // namespace relume
