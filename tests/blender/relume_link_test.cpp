// These tests run the add-on of assets/blender in Blender without a window, and read what it writes.
#include "app/edit/prepare.h"
#include "app/live/reload.h"
#include "assets/base/error.h"
#include "assets/foreign/load_scene.h"
#include "assets/images/image_file.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace relume {
namespace {

const std::string kFolder = std::string(RELUME_SOURCE_DIR) + "/tests/blender/";
const std::string kAddOn = std::string(RELUME_SOURCE_DIR) + "/assets/blender/relume_link.py";
constexpr double kLumensPerWatt = 683;

class RelumeLink : public testing::Test {
protected:
    void SetUp() override {
        if (runProgram("/usr/bin/env", {"blender", "--version"}).status != 0)
            GTEST_SKIP() << "Blender is not there: install Debian's packages blender and python3-numpy";
        blender({"-b", "-P", kFolder + "make_room.py", "--", room_});
        blender({"-b", room_, "-P", kAddOn, "--", level_});
    }
    static std::string blender(std::vector<std::string> arguments) {
        constexpr double kLimit = 120; // [s]
        arguments.insert(arguments.begin(), {"blender", "--python-exit-code", "1"});
        const ProcessResult run = runProgram("/usr/bin/env", arguments, nullptr, kLimit);
        EXPECT_EQ(run.status, 0) << run.out << run.err;
        return run.out;
    }
    static Scene loaded(const std::string& path) {
        ImportDesc desc;
        desc.path = path;
        desc.program = RELUME_BINARY;
        return loadImported(path, importForeign(desc));
    }
    PreparedScene prepared() const { return prepareScene({.path = level_, .size = 64}); }

    TemporaryFolder folder_;
    const std::string room_ = folder_.path("room.blend"), level_ = folder_.path("room.relume.glb");
};

TEST_F(RelumeLink, LightsAndSkyAreThoseOfBlender) {
    const Scene scene = loadGltf(level_);
    ASSERT_EQ(scene.lights.size(), 2u);
    const bool panelFirst = scene.lights[0].type == LightType::Rectangle;
    const Light &panel = scene.lights[panelFirst ? 0 : 1], &bulb = scene.lights[panelFirst ? 1 : 0];
    ASSERT_EQ(panel.type, LightType::Rectangle);
    EXPECT_EQ(panel.name, "Panel");
    EXPECT_NEAR(double(panel.size.x), 1.0, 1e-6);
    EXPECT_NEAR(double(panel.size.y), 0.5, 1e-6);
    // Cycles has 100 W over half a square metre as 100 / (4 x 0.5) W/(m^2 sr): the middle of a white floor 4
    // m below such a light of 0.01 m^2 was measured as 0.4971, and P / (4 pi 4^2) is 0.4974.
    EXPECT_NEAR(double(panel.intensity), 100 * kLumensPerWatt / (4 * 0.5), 1.0);
    // Blender's Z is up and its light shines down, tilted by 0.3 about X.
    EXPECT_LT(glm::distance(glm::vec3(panel.transform[3]), glm::vec3(0, 3, 0)), 1e-5f);
    EXPECT_LT(glm::distance(-glm::normalize(glm::vec3(panel.transform[2])),
                            glm::vec3(0, -std::cos(0.3f), -std::sin(0.3f))),
              1e-5f);
    EXPECT_LT(glm::distance(glm::normalize(glm::vec3(panel.transform[0])), glm::vec3(1, 0, 0)), 1e-5f);
    ASSERT_EQ(bulb.type, LightType::Point);
    EXPECT_NEAR(double(bulb.intensity), 50 * kLumensPerWatt / (4 * std::numbers::pi), 0.1);
    EXPECT_NEAR(double(bulb.radius), 0.1, 1e-6);
    EXPECT_LT(glm::distance(glm::vec3(bulb.transform[3]), glm::vec3(-1, 2, -1)), 1e-5f);
    EXPECT_NEAR(double(scene.sky.radiance.b), 0.4 * 0.5 * kLumensPerWatt, 0.01);
    const auto glow = std::find_if(scene.materials.begin(), scene.materials.end(),
                                   [](const Material& material) { return material.name == "Box"; });
    ASSERT_NE(glow, scene.materials.end());
    EXPECT_NEAR(double(glow->emission.r), 2 * kLumensPerWatt, 0.1)
        << "as bright beside the lamps as in Blender";
    EXPECT_EQ(scene.instances.size(), 2u) << "what carries an area light is no object";
}

TEST_F(RelumeLink, ABlendFileOpensByBlender) {
    const Scene exported = loadGltf(level_), opened = loaded(room_);
    EXPECT_EQ(opened.path, room_);
    ASSERT_EQ(opened.lights.size(), exported.lights.size());
    for (size_t i = 0; i < opened.lights.size(); ++i) {
        EXPECT_EQ(opened.lights[i].name, exported.lights[i].name);
        EXPECT_EQ(opened.lights[i].intensity, exported.lights[i].intensity);
        EXPECT_EQ(opened.lights[i].transform, exported.lights[i].transform);
    }
    EXPECT_EQ(opened.sky.radiance, exported.sky.radiance);
    std::ofstream(folder_.path("bad.blend")) << "BLENDER-v304 and no more";
    try {
        loaded(folder_.path("bad.blend"));
        FAIL() << "Blender has opened something else";
    } catch (const Error& error) {
        EXPECT_TRUE(contains(error.what(), "bad.blend: Blender cannot read it")) << error.what();
    }
}

/// W/sr or W/m^2 in each light's own direction: what a small light far away is seen by.
double alongItself(const Light& light) {
    const double area = light.type == LightType::Rectangle ? double(light.size.x) * light.size.y
                        : light.type == LightType::Disc    ? std::numbers::pi * light.radius * light.radius
                                                           : 1.0;
    return light.intensity * area / kLumensPerWatt;
}

const Light& named(const Scene& scene, const std::string& name) {
    for (const Light& light : scene.lights)
        if (light.name == name) return light;
    throw Error("no light is named " + name);
}

const Material& glowing(const Scene& scene) {
    for (const Material& material : scene.materials)
        if (material.name == "Box") return material;
    throw Error("no material is named Box");
}

TEST_F(RelumeLink, AllWaysGiveTheSameLight) {
    const std::string room = folder_.path("lamps.blend"), level = folder_.path("lamps.glb");
    blender({"-b", "-P", kFolder + "make_lamps.py", "--", room, folder_.path("lamps.fbx"),
             folder_.path("lamps.obj"), folder_.path("lamps.dae")});
    blender({"-b", room, "-P", kAddOn, "--", level});
    const Scene exported = loadGltf(level);
    const struct {
        const char* name;
        double watts;
    } lights[] = {{"Bulb", 50 / (4 * std::numbers::pi)},
                  {"Spot", 40 / (4 * std::numbers::pi)},
                  {"Sun", 3},
                  {"Panel", 100 / 4.0},
                  {"Disc", 60 / 4.0}};
    std::vector<std::string> others = {"lamps.fbx"};
    if (std::filesystem::exists(folder_.path("lamps.dae"))) others.emplace_back("lamps.dae");
    for (const auto& light : lights)
        EXPECT_NEAR(alongItself(named(exported, light.name)) / light.watts, 1, 1e-4) << light.name;
    for (const std::string& other : others) {
        const Scene scene = loaded(folder_.path(other));
        ASSERT_EQ(scene.lights.size(), exported.lights.size()) << other;
        for (const auto& light : lights) {
            const Light &one = named(exported, light.name), &same = named(scene, light.name);
            EXPECT_LT(glm::distance(one.transform[3], same.transform[3]), 1e-4f)
                << other << ' ' << light.name;
            // Blender writes area lights into .dae files as points.
            if (same.type == LightType::Point && one.type != LightType::Point) continue;
            EXPECT_NEAR(alongItself(same) / light.watts, 1, 1e-4) << other << ' ' << light.name;
            EXPECT_LT(glm::distance(one.color, same.color), 1e-4f) << other << ' ' << light.name;
            EXPECT_NEAR(one.outerConeAngle, same.outerConeAngle, 1e-3f) << other << ' ' << light.name;
            if (one.type == LightType::Point) continue;
            EXPECT_LT(glm::distance(one.transform[2], same.transform[2]), 1e-3f)
                << other << ' ' << light.name;
        }
    }
    const glm::vec3 glow = glowing(exported).emission;
    EXPECT_LT(glm::distance(glow, 2.0f * float(kLumensPerWatt) * glm::vec3(1, 0.5f, 0.25f)), 0.1f);
    for (const char* other : {"lamps.fbx", "lamps.obj"}) {
        const Material material = glowing(loaded(folder_.path(other)));
        EXPECT_LT(glm::distance(material.emission, glow), 0.1f) << other;
        EXPECT_LT(glm::distance(material.baseColor, glowing(exported).baseColor), 1e-3f) << other;
    }
}

TEST_F(RelumeLink, ASavedLampIsAnEditOfTheBakeAndTheLightmapComesBack) {
    const PreparedScene before = prepared();
    FloatImage lightmap{8, 8, {}, {}, {}};
    for (const char* channel : {"R", "G", "B"})
        lightmap.add(channel).assign(64, 0.5f);
    writeImage(folder_.path("lightmap.exr"), lightmap);
    const std::string said =
        blender({"-b", room_, "-P", kFolder + "work_on_room.py", "--", kAddOn, folder_.path("lightmap.exr")});
    EXPECT_TRUE(contains(said, "took the lightmap")) << said;
    const SceneChanges changes = changesBetween(before.scene, before, prepared());
    EXPECT_EQ(describe(changes), "1 light");
    EXPECT_FALSE(changes.surfaces) << "the bake would begin anew";
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path("")))
        EXPECT_FALSE(contains(entry.path().string(), ".part")) << entry.path();
}

} // namespace
} // namespace relume
