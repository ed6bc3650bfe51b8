#include "app/offline/chosen_lights.h"

#include "assets/base/error.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

using LightNames = std::vector<std::string>;

const LightNames kNames = {"Lamp", "Lamp, old", "old", "Sky"};

std::string refusalOf(const LightNames& typed, const LightNames& names = kNames) {
    try {
        chosenLights("--lights", typed, names);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "none";
}

TEST(ChosenLights, ComeInTheScenesOrder) {
    EXPECT_EQ(chosenLights("--lights", {"Sky,Lamp"}, kNames), (LightNames{"Lamp", "Sky"}));
    EXPECT_EQ(chosenLights("--lights", {"Sky", "old", "Lamp"}, kNames), (LightNames{"Lamp", "old", "Sky"}));
    EXPECT_EQ(chosenLights("--lights", {"Lamp"}, kNames), LightNames{"Lamp"});
}

TEST(ChosenLights, MayHaveCommasInTheirNames) {
    EXPECT_EQ(chosenLights("--lights", {"Lamp, old"}, kNames), LightNames{"Lamp, old"});
    EXPECT_EQ(chosenLights("--lights", {"Lamp,Lamp, old,old"}, kNames),
              (LightNames{"Lamp", "Lamp, old", "old"}));
    EXPECT_EQ(chosenLights("--lights", {"Lamp,old"}, kNames), (LightNames{"Lamp", "old"}));
}

TEST(ChosenLights, AreRefusedWhereTheyAreUnknown) {
    const std::string all = "the scene has 'Lamp', 'Lamp, old', 'old', 'Sky'";
    EXPECT_EQ(refusalOf({"Lamp,sky"}), "--lights: 'sky' is no light: " + all);
    EXPECT_EQ(refusalOf({"Lam"}), "--lights: 'Lam' is no light: " + all);
    EXPECT_EQ(refusalOf({"Lamps"}), "--lights: 'Lamps' is no light: " + all);
    EXPECT_EQ(refusalOf({"Sky,"}), "--lights: '' is no light: " + all);
    EXPECT_EQ(refusalOf({""}), "--lights: '' is no light: " + all);
    EXPECT_EQ(refusalOf({}), "--lights: names no light: " + all);
    EXPECT_EQ(refusalOf({"Lamp"}, {}), "--lights: 'Lamp' is no light: nothing shines in the scene");
}

TEST(ChosenLights, AreRefusedWhereTheyAreNamedTwice) {
    EXPECT_EQ(refusalOf({"old,Sky,old"}),
              "--lights: 'old' is named twice: the scene has 'Lamp', 'Lamp, old', 'old', 'Sky'");
    EXPECT_EQ(refusalOf({"Sky", "Sky"}),
              "--lights: 'Sky' is named twice: the scene has 'Lamp', 'Lamp, old', 'old', 'Sky'");
}

TEST(ChosenLights, AreCalledAsLayersAre) {
    Scene scene;
    scene.lights.resize(2);
    scene.lights[0].name = scene.lights[1].name = "Lamp";
    scene.sky.radiance = glm::vec3(1.0f);
    EXPECT_EQ(lightNames(scene), (LightNames{"Lamp", "Lamp 2", "Sky"}));
}

} // namespace
} // namespace relume
