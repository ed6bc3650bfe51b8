#include "app/viewer/edits/light_edits.h"
#include "app/viewer/picture/light_overlay.h"
#include "assets/model/scene_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

using Kind = LightKey::Kind;

LightKey lamp(uint32_t index) {
    return {Kind::Lamp, index, 0};
}

Document withLamps(size_t count) {
    Document document;
    for (size_t i = 0; i < count; ++i) {
        Light light;
        light.name = "Lamp";
        addLamp(document, light);
    }
    return document;
}

glm::vec3 direction(const glm::mat4& transform) {
    return -glm::normalize(glm::vec3(transform[2]));
}

TEST(LightEdits, PreviewLightIsKeptOnRequest) {
    Document document = withLamps(3);
    std::vector<Light>& lights = document.edits.lights;
    EXPECT_FALSE(hasPreview(document.edits));
    lights[0].name = "Preview sun";
    lights[0].preview = lights[1].preview = true;
    EXPECT_TRUE(hasPreview(document.edits));
    EXPECT_TRUE(isPreview(document.edits, lamp(0)));
    EXPECT_FALSE(isPreview(document.edits, lamp(2)));
    EXPECT_FALSE(isPreview(document.edits, lamp(7)));
    EXPECT_FALSE(isPreview(document.edits, {Kind::Sky, 0, 0}));
    document.edits.sky.preview = true;
    EXPECT_TRUE(isPreview(document.edits, {Kind::Sky, 0, 0}));
    const LightKey copy = duplicateLamp(document, 0);
    EXPECT_FALSE(isPreview(document.edits, copy)) << "what a user makes is theirs";
    keepPreview(document.edits);
    EXPECT_FALSE(hasPreview(document.edits));
    EXPECT_EQ(lights[0].name, "Sun");
    EXPECT_EQ(lights[1].name, "Lamp 2") << "another name stays";
}

// A field takes 1e39, which is infinite.
TEST(LightEdits, WhatIsTypedBecomesANumberOfUse) {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    EXPECT_EQ(typedColour({-1.0f, kInfinite, 0.5f}), glm::vec3(0.0f, kBrightest, 0.5f));
    EXPECT_EQ(typedAngles({kInfinite, -kInfinite, std::nanf("")}), glm::vec3(0.0f));
    EXPECT_EQ(typedAngles({-30.0f, 360.0f, 400.0f}), glm::vec3(-30.0f, 360.0f, 40.0f));
    EXPECT_EQ(typedAngle(-725.0f), -5.0f);
}

TEST(LightEdits, PowerGoesWhereTheLightHasIt) {
    SceneEdits edits;
    edits.materials.resize(2);
    edits.materials[1].emission = {2.0f, 1.0f, 0.5f};
    edits.lights.resize(1);
    const LightKey emitter{Kind::Emitter, 7, 1}, sky{Kind::Sky, 0, 0};
    EXPECT_EQ(powerOf(edits, emitter).intensity, 2.0f);
    EXPECT_EQ(powerOf(edits, emitter).color, glm::vec3(1.0f, 0.5f, 0.25f));
    setPower(edits, emitter, {{1.0f, 0.5f, 0.25f}, 8.0f});
    EXPECT_EQ(edits.materials[1].emission, glm::vec3(8.0f, 4.0f, 2.0f));
    setPower(edits, lamp(0), {{1.0f, 0.5f, -1.0f}, -3.0f});
    EXPECT_EQ(edits.lights[0].color, glm::vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(edits.lights[0].intensity, 0.0f);
    setPower(edits, sky, {{0.5f, 1.0f, 1.0f}, 3.0f});
    EXPECT_EQ(edits.sky.radiance, glm::vec3(1.5f, 3.0f, 3.0f));
    EXPECT_STREQ(lightUnitOf(edits, lamp(0)), "cd");
    EXPECT_STREQ(lightUnitOf(edits, sky), "cd/m^2");
    EXPECT_STREQ(lightTypeOf(edits, emitter), "emitter");
}

TEST(LightEdits, NewLampsHaveNamesOfTheirOwnAndNoNode) {
    Document document = withLamps(3);
    const std::vector<Light>& lights = document.edits.lights;
    EXPECT_EQ(lights[0].name, "Lamp");
    EXPECT_EQ(lights[1].name, "Lamp 2");
    EXPECT_EQ(lights[2].name, "Lamp 3");
    document.edits.lights[0].node = 5;
    const LightKey copy = duplicateLamp(document, 0);
    EXPECT_EQ(copy, lamp(3));
    EXPECT_EQ(lights[3].node, -1) << "the file has it not";
    EXPECT_GT(glm::distance(lights[3].transform[3], lights[0].transform[3]), 0.1f) << "beside it";
}

TEST(LightEdits, ErasingALampKeepsTheSwitchesOfTheOthers) {
    Document document = withLamps(3);
    toggle(document.mix.muted, lamp(0));
    toggle(document.mix.muted, lamp(2));
    eraseLamp(document, 0);
    EXPECT_EQ(document.edits.lights.size(), 2u);
    EXPECT_EQ(document.mix.muted, std::vector{lamp(1)});
    toggle(document.mix.muted, lamp(1));
    EXPECT_TRUE(document.mix.muted.empty());
}

// Returns a camera at the origin that looks at something 5 m away.
LightSpot spotAhead() {
    return {.camera = glm::mat4(1.0f), .seen = {0.0f, 0.0f, -5.0f}, .lighting = glm::vec3(20.0f)};
}

TEST(LightEdits, NewLightsShineAsBrightAsTheSceneIs) {
    const LightSpot spot = spotAhead();
    const float wanted = 20.0f * std::numbers::pi_v<float>; // irradiance
    for (const LightType type : {LightType::Point, LightType::Spot, LightType::Rectangle, LightType::Disc}) {
        const Light light = makeLight(type, spot);
        const float distance = glm::distance(glm::vec3(light.transform[3]), spot.seen);
        float area = 1.0f;
        if (type == LightType::Rectangle) area = light.size.x * light.size.y;
        if (type == LightType::Disc) area = std::numbers::pi_v<float> * light.radius * light.radius;
        EXPECT_NEAR(light.intensity * area / (distance * distance), wanted, 1e-3f * wanted);
        EXPECT_LT(light.transform[3].z, 0.0f) << "before the eye";
        EXPECT_GT(light.transform[3].z, spot.seen.z) << "before what is seen";
    }
    const Light sun = makeLight(LightType::Directional, spot);
    EXPECT_NEAR(sun.intensity, wanted, 1e-3f);
    EXPECT_LT(direction(sun.transform).y, -0.5f) << "from above";
    const SkySettings sky = makeSky({}, spot);
    EXPECT_NEAR(sky.radiance.g, 20.0f, 1e-3f);
    LightSpot dark = spot;
    dark.lighting = glm::vec3(0.0f);
    EXPECT_GT(makeLight(LightType::Point, dark).intensity, 0.0f);
}

TEST(LightEdits, AnglesAreFoundAgain) {
    for (const glm::vec3 angles : {glm::vec3(30, -40, 10), glm::vec3(-170, 80, -60), glm::vec3(5, 0, 0)}) {
        glm::mat4 transform = glm::translate(glm::mat4(1.0f), {1, 2, 3});
        transform = withAngles(transform, angles);
        EXPECT_EQ(transform[3], glm::vec4(1, 2, 3, 1));
        EXPECT_LT(glm::distance(lightAngles(transform), angles), 0.02f);
    }
    for (const float tilt : {-90.0f, 90.0f}) { // turn and roll are one
        const glm::mat4 upright = withAngles(glm::mat4(1.0f), {25.0f, tilt, 40.0f});
        const glm::mat4 again = withAngles(glm::mat4(1.0f), lightAngles(upright));
        for (int column = 0; column < 3; ++column)
            EXPECT_LT(glm::distance(upright[column], again[column]), 1e-3f) << tilt;
        EXPECT_NEAR(direction(upright).y, tilt / 90.0f, 1e-5f);
    }
}

TEST(LightEdits, AimsWhereItIsTold) {
    for (const glm::vec3 way :
         {glm::vec3(0, -2, 0), glm::vec3(0, 1, 0), glm::vec3(1, 0, 0), glm::vec3(-1, -2, 3)}) {
        const glm::mat4 aimed = aimedAlong(withAngles(glm::mat4(1.0f), {15, 20, 30}), way);
        EXPECT_LT(glm::distance(direction(aimed), glm::normalize(way)), 1e-4f);
        EXPECT_NEAR(glm::determinant(aimed), 1.0f, 1e-4f);
    }
}

TEST(LightEdits, SitsOnASurface) {
    Light light;
    light.type = LightType::Point;
    light.radius = 0.5f;
    const glm::vec3 place(1, 2, 3), normal(0, 0, 1);
    EXPECT_LT(glm::distance(glm::vec3(placedOn(light, place, normal, 0.1f)[3]), place + 0.6f * normal),
              1e-5f);
    light.type = LightType::Rectangle;
    const glm::mat4 flat = placedOn(light, place, normal, 0.1f);
    EXPECT_LT(glm::distance(glm::vec3(flat[3]), place + 0.1f * normal), 1e-5f);
    EXPECT_LT(glm::distance(direction(flat), normal), 1e-4f) << "away from the surface";
}

TEST(LightEdits, ASurfacesNormalIsThatOfItsTriangle) {
    WorldMesh mesh;
    // These are a floor, a wall, and another instance's floor just above.
    mesh.positions = {{0, 0, 0}, {1, 0, 0},     {0, 0, -1},    {0, 0, 0},     {0, 0, -1},
                      {0, 1, 0}, {0, 0.01f, 0}, {1, 0.01f, 0}, {0, 0.01f, -1}};
    mesh.material = {0, 0, 0};
    mesh.instance = {0, 0, 1};
    const glm::vec3 above(0.2f, 0.9f, 0.1f);
    EXPECT_LT(glm::distance(normalAt(mesh, 0, {0.3f, 0, -0.3f}, above), {0, 1, 0}), 1e-5f);
    EXPECT_LT(glm::distance(normalAt(mesh, 0, {0.3f, 0, -0.3f}, -above), {0, -1, 0}), 1e-5f)
        << "its other side";
    EXPECT_LT(glm::distance(normalAt(mesh, 0, {0, 0.4f, -0.3f}, {1, 0, 0}), {1, 0, 0}), 1e-5f);
    EXPECT_EQ(normalAt(mesh, 5, {0, 0, 0}, above), above);
}

TEST(LightOverlay, TheNearestIconIsTaken) {
    Document document = withLamps(3);
    document.edits.lights[0].transform[3] = glm::vec4(0, 0, 0, 1);
    document.edits.lights[1].transform[3] = glm::vec4(0.1f, 0, 0, 1);
    document.edits.lights[2].transform[3] = glm::vec4(0, 0, 9, 1); // behind the eye
    ViewState state;
    ScreenView screen;
    screen.camera.eye = {0, 0, 5};
    screen.size = {800, 600};
    const LightStage stage{document.edits, document.mix, state, screen, {}, 1.0f};
    const glm::vec2 second = project(screen, {0.1f, 0, 0}).value();
    EXPECT_EQ(iconAt(stage, {400, 300}), lamp(0));
    EXPECT_EQ(iconAt(stage, second + 2.0f), lamp(1));
    EXPECT_EQ(iconAt(stage, {100, 100}), std::nullopt);
    EXPECT_EQ(selectedLamp(stage), nullptr);
    state.light = lamp(1);
    EXPECT_EQ(selectedLamp(stage), &document.edits.lights[1]);
    state.light = lamp(9);
    EXPECT_EQ(selectedLamp(stage), nullptr);
    state.lightIcons = false;
    EXPECT_EQ(iconAt(stage, {400, 300}), std::nullopt);
}

} // namespace
} // namespace relume
