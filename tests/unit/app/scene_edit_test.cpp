// This tests edits as they are typed: what each does to a scene, and what is wrong with those that do
// nothing.
#include "app/edit/edit_options.h"

#include "app/edit/scene_names.h"
#include "assets/model/light_names.h"
#include "app/text/near_names.h"
#include "assets/base/error.h"
#include "assets/gltf/edit/gltf_edit.h"
#include "assets/model/black_body.h"
#include "tests/unit/edited_file.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace relume {
namespace {

using nlohmann::json;

/// Makes an analytic light of every kind, two objects of one glowing material, a mesh light with two
/// materials and a chair that shares its name with a light.
Scene room() {
    Scene scene;
    for (const char* name : {"Paint", "Glow", "Screen"})
        scene.materials.emplace_back().name = name;
    scene.materials[1].emission = {100, 50, 10};
    scene.materials[2].emission = {3, 3, 3};
    const auto mesh = [&](std::vector<int> materials) {
        Mesh& made = scene.meshes.emplace_back();
        for (const int material : materials)
            made.primitives.emplace_back().material = material;
    };
    mesh({0});
    mesh({1});
    mesh({1, 2});
    const auto object = [&](const char* name, int index) {
        scene.instances.push_back({.name = name, .mesh = index, .node = int(scene.instances.size())});
    };
    object("Chair", 0);
    object("Tube", 1);
    object("Tube", 1);
    object("Set", 2);
    object("Bulb", 0);
    for (const LightType type :
         {LightType::Point, LightType::Spot, LightType::Directional, LightType::Rectangle, LightType::Disc}) {
        Light light;
        light.type = type;
        light.name = type == LightType::Point ? "Lamp" : lightTypeName(type);
        light.intensity = 10;
        light.radius = type == LightType::Disc ? 0.2f : 0.0f;
        scene.lights.push_back(light);
    }
    scene.lights.push_back(scene.lights[0]); // "Lamp 2"
    scene.lights.push_back(scene.lights[0]);
    scene.lights.back().name = "Bulb";
    return scene;
}

class SceneEditTest : public testing::Test {
protected:
    std::string edit(const std::string& option, const std::string& text) {
        return applyEdit(scene_, sceneEditOf(option, text), edits_);
    }
    std::string set(const std::string& text) { return edit("--set", text); }
    Light& light(const std::string& name) {
        for (Light& candidate : edits_.lights)
            if (candidate.name == name) return candidate;
        throw Error("no light " + name);
    }
    /// Returns the message of an edit that must change nothing; it starts with "usage: " for wrong values.
    std::string refused(const std::string& option, const std::string& text) {
        const SceneEdits before = edits_;
        std::string message = "no error";
        try {
            edit(option, text);
        } catch (const UsageError& error) {
            message = std::string("usage: ") + error.what();
        } catch (const Error& error) {
            message = error.what();
        }
        EXPECT_EQ(message.find('\n'), std::string::npos);
        EXPECT_EQ(edits_.lights, before.lights);
        EXPECT_EQ(edits_.sky, before.sky);
        EXPECT_EQ(edits_.placements, before.placements);
        EXPECT_EQ(edits_.densities, before.densities);
        for (size_t i = 0; i < before.materials.size(); ++i) {
            EXPECT_EQ(edits_.materials[i].emission, before.materials[i].emission);
            EXPECT_EQ(edits_.materials[i].baseColor, before.materials[i].baseColor);
        }
        return message;
    }

    const Scene scene_ = room();
    SceneEdits edits_ = editsOf(scene_);
};

TEST_F(SceneEditTest, SetsEveryPropertyOfLights) {
    EXPECT_EQ(set("Lamp.intensity=2.5"), "light 'Lamp': intensity 2.5");
    set("Lamp.radius=0.1");
    set("Lamp.range=7");
    set("spot.inner=10");
    set("spot.outer=60");
    set("directional.angle=0.53");
    set("rectangle.size=1.2,0.3");
    set("disc.radius=0.25");
    EXPECT_EQ(light("Lamp").intensity, 2.5f);
    EXPECT_EQ(light("Lamp").radius, 0.1f);
    EXPECT_EQ(light("Lamp").range, 7.0f);
    EXPECT_FLOAT_EQ(light("spot").innerConeAngle, glm::radians(10.0f));
    EXPECT_FLOAT_EQ(light("spot").outerConeAngle, glm::radians(60.0f));
    EXPECT_FLOAT_EQ(light("directional").angle, glm::radians(0.53f));
    EXPECT_EQ(light("rectangle").size, glm::vec2(1.2f, 0.3f));
    EXPECT_EQ(light("disc").radius, 0.25f);
    set("disc.name=Down=light.intensity");
    EXPECT_EQ(edits_.lights[4].name, "Down=light.intensity");
    set("Down=light.intensity.intensity=3");
    EXPECT_EQ(edits_.lights[4].intensity, 3.0f);
}

TEST_F(SceneEditTest, SetsTheDensityOfObjects) {
    const std::string name = scene_.instances[0].name;
    EXPECT_EQ(set(name + ".density=2"), "object '" + name + "': density 2");
    EXPECT_EQ(edits_.densities[0], 2.0f);
    Scene edited = scene_;
    applyEdits(edited, edits_);
    EXPECT_EQ(edited.instances[0].density, 2.0f);
    EXPECT_EQ(editsOf(edited).densities, edits_.densities);
    EXPECT_EQ(refused("--set", name + ".density=0"),
              "usage: density 0 is out of range: give a factor on the texels per metre, from 0.01 to 100");
    EXPECT_NE(refused("--set", "Lamp.density=2"), "no error");
}

TEST_F(SceneEditTest, ColorsAreSrgbInHexAndLinearAsNumbers) {
    set("Lamp.color=#ff8000");
    EXPECT_EQ(light("Lamp").color.r, 1.0f);
    EXPECT_NEAR(light("Lamp").color.g, 0.2158605f, 1e-6f); // ((128/255 + 0.055) / 1.055)^2.4
    EXPECT_EQ(light("Lamp").color.b, 0.0f);
    set("Lamp.color=1,0.5,0.25");
    EXPECT_EQ(light("Lamp").color, glm::vec3(1, 0.5f, 0.25f));
    set("spot.temperature=2700");
    EXPECT_EQ(light("spot").color, blackBody(2700.0f));
    EXPECT_EQ(light("spot").intensity, 10.0f);
}

TEST_F(SceneEditTest, EmittersShareTheEmissionOfTheirMaterial) {
    EXPECT_EQ(set("Tube 2.strength=200"),
              "light 'Tube 2': strength 200, of the material 'Glow', which 3 objects have");
    EXPECT_EQ(edits_.materials[1].emission, glm::vec3(200, 100, 20));
    set("Set / Screen.color=#0000ff");
    EXPECT_EQ(edits_.materials[2].emission, glm::vec3(0, 0, 3));
    set("Glow.strength=0");
    EXPECT_EQ(edits_.materials[1].emission, glm::vec3(0));
    set("Glow.strength=5"); // its colour went with its light
    EXPECT_EQ(edits_.materials[1].emission, glm::vec3(5));
    set("Paint.emission=1,2,3");
    set("Paint.baseColor=0.1,0.2,0.3");
    EXPECT_EQ(edits_.materials[0].emission, glm::vec3(1, 2, 3));
    EXPECT_EQ(edits_.materials[0].baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 1));
}

TEST_F(SceneEditTest, ColorAndStrengthOfARadianceDoNotTouchEachOther) {
    SceneEdits other = edits_;
    for (const char* text : {"Glow.strength=8", "Set / Glow.color=0.5,0.25,0"})
        applyEdit(scene_, sceneEditOf("--set", text), edits_);
    for (const char* text : {"Set / Glow.color=0.5,0.25,0", "Glow.strength=8"})
        applyEdit(scene_, sceneEditOf("--set", text), other);
    EXPECT_EQ(edits_.materials[1].emission, glm::vec3(8, 4, 0));
    EXPECT_EQ(other.materials[1].emission, glm::vec3(8, 4, 0));
}

TEST_F(SceneEditTest, TheSkyIsAddedSetAndDeleted) {
    EXPECT_EQ(refused("--set", "Sky.color=#ffffff"),
              "the sky does not shine and has no colour: set its intensity first");
    edit("--add", "sky,color=0.25,0.5,1,intensity=200,rotation=90");
    EXPECT_EQ(edits_.sky.radiance, glm::vec3(50, 100, 200));
    EXPECT_FLOAT_EQ(edits_.sky.rotation, glm::radians(90.0f));
    set("Sky.intensity=2");
    EXPECT_EQ(edits_.sky.radiance, glm::vec3(0.5f, 1, 2));
    EXPECT_EQ(refused("--add", "sky"),
              "the scene has a sky already: set that one's properties, or delete it first");
    EXPECT_NE(refused("--set", "Sky.file=missing.exr").find("missing.exr"), std::string::npos);
    edit("--delete", "Sky");
    EXPECT_EQ(edits_.sky, SkySettings());
    EXPECT_EQ(refused("--delete", "Sky"), "the scene has no sky: there is nothing to delete");
    EXPECT_EQ(refused("--add", "sky,radius=2"),
              "usage: a sky has no radius: it has color, temperature, intensity, rotation, file");
}

TEST_F(SceneEditTest, LightsAndObjectsMove) {
    edit("--move", "Lamp=1,2,-3.5");
    EXPECT_EQ(light("Lamp").transform[3], glm::vec4(1, 2, -3.5f, 1));
    EXPECT_EQ(edit("--move", "Lamp+=1,0,0.5"), "light 'Lamp': at 2,2,-3");
    edit("--move", "Tube 2=0,1,0");
    EXPECT_EQ(edits_.placements[2].transform[3], glm::vec4(0, 1, 0, 1));
    EXPECT_EQ(edits_.placements[1].transform, glm::mat4(1.0f));
    edit("--move", "object:Bulb=9,9,9");
    EXPECT_EQ(edits_.placements[4].transform[3].x, 9.0f);
    EXPECT_EQ(light("Bulb").transform, glm::mat4(1.0f));
    EXPECT_EQ(refused("--move", "Bulb=1,1,1"),
              "2 things are called 'Bulb': say 'light:Bulb' or 'object:Bulb'");
}

TEST_F(SceneEditTest, ARotationKeepsScaleAndMirroring) {
    const glm::mat4 scaled = glm::scale(glm::translate(glm::mat4(1), {1, 2, 3}), {2, 3, -0.5f});
    edits_.placements[0].transform =
        glm::rotate(glm::translate(glm::mat4(1), {1, 2, 3}), 0.7f, glm::vec3(1, 2, 3)) *
        glm::scale(glm::mat4(1), {2, 3, -0.5f});
    edit("--rotate", "Chair=0,0,0");
    test::expectNear(edits_.placements[0].transform, scaled);
    // It turns about the world's X, then Y, then Z: +Y goes to +Z by X, to +X by Y, to +Y by Z.
    edit("--rotate", "spot=90,90,90");
    const glm::mat4 turned = light("spot").transform;
    test::expectNear(turned, glm::mat4(0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1), 0.0f);
}

TEST_F(SceneEditTest, LightsAreAimed) {
    edit("--move", "spot=1,3,1");
    edit("--aim", "spot=1,0,-2");
    const glm::mat3 axes(light("spot").transform);
    const glm::vec3 way = glm::normalize(glm::vec3(0, -3, -3));
    EXPECT_LT(glm::length(-axes[2] - way), 1e-6f);
    EXPECT_EQ(axes[0], glm::vec3(1, 0, 0));
    EXPECT_GT(axes[1].y, 0.0f);
    edit("--aim", "spot=1,-5,1"); // straight down
    EXPECT_LT(glm::length(glm::vec3(light("spot").transform[2]) - glm::vec3(0, 1, 0)), 1e-6f);
    EXPECT_NEAR(glm::determinant(glm::mat3(light("spot").transform)), 1.0f, 1e-6f);
    EXPECT_EQ(refused("--aim", "spot=1,3,1"), "the light is at the point it is aimed at: name another point");
    EXPECT_EQ(refused("--aim", "Lamp=1,3,1").find("a point light shines alike"), 0u);
    EXPECT_EQ(refused("--aim", "Chair=1,3,1").find("no light is called 'Chair'"), 0u);
}

TEST_F(SceneEditTest, LightsOfEveryTypeAreAdded) {
    edit("--add", "point");
    edit("--add", "spot,name=Desk, left,position=1,2,3,aim=1,0,3,intensity=300,outer=30,inner=20");
    edit("--add", "directional,rotation=-90,0,0,angle=0.5");
    edit("--add", "rectangle,size=0.5,2,color=#ffffff");
    EXPECT_EQ(edit("--add", "disc,intensity=4"), "light 'disc': added, 4 cd/m^2");
    ASSERT_EQ(edits_.lights.size(), scene_.lights.size() + 5);
    const Light* added = &edits_.lights[scene_.lights.size()];
    EXPECT_EQ(added[0].type, LightType::Point);
    EXPECT_EQ(added[0].name, "point");
    EXPECT_EQ(added[0].node, -1);
    EXPECT_EQ(added[1].name, "Desk, left");
    EXPECT_EQ(added[1].transform[3], glm::vec4(1, 2, 3, 1));
    EXPECT_LT(glm::length(glm::vec3(added[1].transform[2]) - glm::vec3(0, 1, 0)), 1e-6f);
    EXPECT_EQ(added[1].intensity, 300.0f);
    EXPECT_FLOAT_EQ(added[1].outerConeAngle, glm::radians(30.0f));
    EXPECT_EQ(glm::vec3(added[2].transform[2]), glm::vec3(0, 1, 0)); // shines down
    EXPECT_EQ(added[3].size, glm::vec2(0.5f, 2));
    EXPECT_EQ(added[4].radius, 0.5f);
}

TEST_F(SceneEditTest, LightsAreDuplicatedAndDeleted) {
    edits_.lights[0].node = 7;
    EXPECT_EQ(edit("--duplicate", "Lamp"), "light 'Lamp': duplicated as 'Lamp 3'");
    EXPECT_EQ(edits_.lights.back().node, -1);
    EXPECT_EQ(edits_.lights.back().intensity, 10.0f);
    edit("--duplicate", "Lamp=Sofa");
    EXPECT_EQ(edits_.lights.back().name, "Sofa");
    edit("--delete", "Lamp");
    EXPECT_EQ(edits_.lights.size(), scene_.lights.size() + 1);
    EXPECT_EQ(edits_.lights[0].name, "spot");
    EXPECT_EQ(refused("--delete", "Set / Screen"),
              "'Set / Screen' is an object that shines, which cannot be deleted: set its strength to 0");
}

TEST_F(SceneEditTest, ObjectsAreHiddenAndShown) {
    edit("--hide", "Set");
    EXPECT_TRUE(edits_.placements[3].hidden);
    EXPECT_EQ(refused("--set", "Set / Screen.strength=1").find("no light or material is called"), 0u);
    edit("--show", "Set");
    EXPECT_FALSE(edits_.placements[3].hidden);
}

TEST_F(SceneEditTest, WrongValuesAreNamedWithTheirMend) {
    const std::pair<const char*, const char*> wrong[] = {
        {"Lamp.intensity=-1", "usage: intensity -1 is out of range: give a number from 0 to 1e12"},
        {"Lamp.intensity=nan",
         "usage: 'nan' is no intensity of finite numbers: give a number from 0 to 1e12"},
        {"Lamp.intensity=1e99",
         "usage: '1e99' is no intensity of finite numbers: give a number from 0 to 1e12"},
        {"Lamp.intensity=", "usage: '' is no intensity of finite numbers: give a number from 0 to 1e12"},
        {"Lamp.color=#ff80",
         "usage: '#ff80' is no color of finite numbers: give #rrggbb or r,g,b from 0 to 1, "
         "and what is brighter by the intensity"},
        {"Lamp.color=2,1,1",
         "usage: color 2,1,1 is out of range: give #rrggbb or r,g,b from 0 to 1, and what is "
         "brighter by the intensity"},
        {"Lamp.temperature=500", "usage: temperature 500 is out of range: give kelvins from 1000 to 15000"},
        {"spot.outer=95", "usage: outer 95 is out of range: give degrees from the axis, from 0.0573 to 90"},
        {"spot.outer=0", "usage: outer 0 is out of range: give degrees from the axis, from 0.0573 to 90"},
        {"spot.inner=60", "usage: the inner cone of 60 degrees is wider than the outer one of 45: make that "
                          "wider first"},
        {"disc.radius=0", "usage: a disc needs a radius: give metres above 0"},
        {"rectangle.size=1,0",
         "usage: size 1,0 is out of range: give width,height in metres above 0, up to 1e8"},
        {"Lamp.size=1,1",
         "usage: a point light has no size: it has name, intensity, color, temperature, radius, range"},
        {"Glow.baseColor=1,2,3", "usage: baseColor 1,2,3 is out of range: give #rrggbb or r,g,b from 0 to 1"},
        {"Glow.color=1,1,1", "no light is called 'Glow': did you mean 'Set / Glow'?"},
        {"Tube.color=0,0,0", "usage: light 'Tube' cannot be black: set its strength to 0"},
        {"Lamp.intensty=1",
         "usage: 'intensty' is no property: there is name, intensity, color, temperature, "
         "radius, angle, size, range, inner, outer, strength, baseColor, emission, rotation, "
         "file, density"},
        {"Lamp", "usage: write NAME.PROP=VALUE"},
        {"lmap.intensity=1", "no light is called 'lmap': did you mean 'Lamp'?"},
    };
    for (const auto& [text, message] : wrong)
        EXPECT_EQ(refused("--set", text), message) << text;
    EXPECT_EQ(refused("--move", "Lamp=1,2"), "usage: '1,2' are no three finite numbers: give x,y,z");
    EXPECT_EQ(refused("--move", "=1,2,3"), "usage: write NAME=X,Y,Z");
    EXPECT_EQ(refused("--add", "lamp"),
              "usage: 'lamp' is no type: there is point, spot, directional, rectangle, disc and sky");
    EXPECT_EQ(refused("--add", "spot,wide"), "usage: 'wide' has no value: write KEY=VALUE");
    EXPECT_EQ(refused("--add", "spot,inner=80").find("usage: the inner cone of 80 degrees"), 0u);
    EXPECT_EQ(refused("--delete", ""), "usage: names nothing: write NAME");
}

/// Values that no text can say come from another user of the edits.
TEST_F(SceneEditTest, ValuesThatAreNotFiniteAreRefused) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const SceneEdits before = edits_;
    for (const SceneEdit& wrong : std::vector<SceneEdit>{
             SetEdit{"Lamp", {Property::Intensity, nan}}, SetEdit{"Lamp", {Property::Color, glm::vec3(nan)}},
             SetEdit{"rectangle", {Property::Size, glm::vec2(nan)}}, MoveEdit{"Lamp", glm::vec3(nan)},
             RotateEdit{"Lamp", glm::vec3(nan)}, AimEdit{"spot", glm::vec3(nan)},
             AddLightEdit{LightType::Point, {}, glm::vec3(nan), {}, {}}})
        EXPECT_THROW(applyEdit(scene_, wrong, edits_), UsageError);
    EXPECT_EQ(edits_.lights, before.lights);
}

TEST_F(SceneEditTest, EditsAreMadeInTheirOrder) {
    std::vector<TypedEdit> typed;
    for (const auto& [option, text] :
         std::vector<std::pair<std::string, std::string>>{{"--duplicate", "Lamp=New"},
                                                          {"--move", "New=1,0,0"},
                                                          {"--set", "New.intensity=5"},
                                                          {"--delete", "Lamp"}})
        typed.push_back({option, text, sceneEditOf(option, text)});
    EXPECT_EQ(applyEdits(scene_, typed, edits_).size(), 4u);
    EXPECT_EQ(edits_.lights.back().intensity, 5.0f);
    typed.push_back(typed[1]);
    typed.back().text = "Nwe=1,0,0";
    typed.back().edit = sceneEditOf("--move", "Nwe=1,0,0");
    try {
        applyEdits(scene_, typed, edits_);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what())
                      .find("--move 'Nwe=1,0,0': no light or object is called 'Nwe': did "
                            "you mean 'New'"),
                  0u)
            << error.what();
    }
}

TEST(NearNames, ComeByLikeness) {
    const std::vector<std::string> names = {"Ceiling", "Lamp", "Lamp 2", "Desk lamp", "Panel"};
    EXPECT_EQ(nearNames("lamp", names), (std::vector<std::string>{"Lamp", "Lamp 2", "Desk lamp"}));
    EXPECT_EQ(nearNames("Pannel", names), std::vector<std::string>{"Panel"});
    EXPECT_EQ(nearNamesHint("x", {"A", "B"}), "there is 'A' and 'B'");
    EXPECT_EQ(nearNamesHint("x", {}), "there is none");
}

/// These edits go through a file with things that nothing here knows.
using SceneEditFile = test::EditedFile;

TEST_F(SceneEditFile, EditsReachTheFileAndAllElseStays) {
    test::LitScene builder;
    builder.json["materials"] = json::array({{{"name", "Paint"}, {"extras", {{"id", 7}}}}});
    builder.json["meshes"][0]["primitives"][0]["material"] = 0;
    builder.json["accessors"][0]["extensions"] = {{"ACME_accessor", {{"scale", 0.5}}}};
    builder.json["nodes"][0]["name"] = "Floor";
    builder.lamp({{"translation", {1, 2, 3}}, {"extras", {{"id", 1}}}},
                 builder.light({{"type", "point"}, {"name", "Lamp"}, {"intensity", 40}}));
    const std::string path = write(builder);
    json expected = test::jsonOf(path);
    const std::string chunks = test::chunksOf(path);

    const Scene before = loadGltf(path);
    SceneEdits edits = editsOf(before);
    for (const auto& [option, text] : std::vector<std::pair<std::string, std::string>>{
             {"--set", "Lamp.intensity=2.5"},
             {"--set", "Lamp.color=1,0.5,0.25"},
             {"--set", "Paint.strength=300"},
             {"--set", "Sky.intensity=0.5"},
             {"--move", "Lamp=1,2,4"},
             {"--move", "Floor=0,0.5,0"},
             {"--add", "rectangle,name=Panel,intensity=3000,position=0,2,0,rotation=-90,0,0"}})
        applyEdit(before, sceneEditOf(option, text), edits);
    Scene after = partsOfEdits(before);
    applyEdits(after, edits);
    saveEditedGltf(path, before, after, path);

    const Scene back = loadGltf(path);
    ASSERT_EQ(back.lights.size(), 2u);
    EXPECT_EQ(back.lights[0].intensity, 2.5f);
    EXPECT_EQ(back.lights[0].color, glm::vec3(1, 0.5f, 0.25f));
    EXPECT_EQ(back.lights[0].transform[3], glm::vec4(1, 2, 4, 1));
    EXPECT_EQ(back.lights[1].name, "Panel");
    EXPECT_EQ(back.lights[1].transform[3], glm::vec4(0, 2, 0, 1));
    EXPECT_EQ(back.materials[0].emission, glm::vec3(300));
    EXPECT_EQ(back.sky.radiance, glm::vec3(0.5f));
    EXPECT_EQ(back.instances[0].transform[3], glm::vec4(0, 0.5f, 0, 1));

    const json written = test::jsonOf(path);
    EXPECT_EQ(test::chunksOf(path), chunks);
    for (const char* section : {"accessors", "bufferViews", "buffers", "meshes", "asset"})
        EXPECT_EQ(written[section], expected[section]) << section;
    EXPECT_EQ(written["nodes"][1]["extras"], expected["nodes"][1]["extras"]);
    EXPECT_EQ(written["materials"][0]["extras"], expected["materials"][0]["extras"]);
}

} // namespace
} // namespace relume
