#include "bake/layers/light_groups.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

/// Makes half of the lamps, the suns, a sky, and the other lamps; names are "lamp 0", "sun 2", ..., "Sky".
Scene sceneOf(uint32_t suns, uint32_t lamps, bool sky) {
    Scene scene;
    const auto add = [&](const char* kind, LightType type) {
        scene.lights.emplace_back();
        scene.lights.back().type = type;
        scene.lights.back().name = std::string(kind) + " " + std::to_string(scene.lights.size() - 1);
    };
    for (uint32_t i = 0; i < lamps / 2; ++i)
        add("lamp", LightType::Point);
    for (uint32_t i = 0; i < suns; ++i)
        add("sun", LightType::Directional);
    for (uint32_t i = lamps / 2; i < lamps; ++i)
        add("lamp", LightType::Spot);
    if (sky) scene.sky.radiance = glm::vec3(1.0f);
    return scene;
}

std::string groupsOf(const Scene& scene, uint64_t room) {
    std::string text;
    for (const LightGroup& group : groupLights(scene, lightSources(scene), room)) {
        text += (text.empty() ? "" : ", ") + group.source.name;
        if (group.members.empty()) continue;
        EXPECT_EQ(group.source.key.kind, LightKey::Kind::Group);
        text += ":";
        for (const LightSource& member : group.members)
            text += " " + member.name;
    }
    return text;
}

} // namespace

TEST(LightGroups, LightsThatFindRoomAreByThemselves) {
    EXPECT_EQ(groupsOf(sceneOf(1, 2, true), 4), "lamp 0, sun 1, lamp 2, Sky");
    EXPECT_EQ(groupsOf(sceneOf(0, 0, false), 0), "");
}

TEST(LightGroups, SunAndSkyAreKeptApartFirst) {
    EXPECT_EQ(groupsOf(sceneOf(1, 4, true), 4), "sun 2, Sky, rest: lamp 0 lamp 1 lamp 3 lamp 4");
    EXPECT_EQ(groupsOf(sceneOf(1, 4, true), 3), "sun 2, rest: lamp 0 lamp 1 lamp 3 lamp 4 Sky");
    EXPECT_EQ(groupsOf(sceneOf(0, 4, false), 3), "lamp 0, rest: lamp 1 lamp 2 lamp 3");
}

TEST(LightGroups, OthersAreKeptApartInTheirOrderAsFarAsThereIsRoom) {
    EXPECT_EQ(groupsOf(sceneOf(1, 4, true), 5), "lamp 0, sun 2, Sky, rest: lamp 1 lamp 3 lamp 4");
    EXPECT_EQ(groupsOf(sceneOf(0, 5, false), 4), "lamp 0, lamp 1, rest: lamp 2 lamp 3 lamp 4");
}

TEST(LightGroups, ManySunsShareALayer) {
    EXPECT_EQ(groupsOf(sceneOf(3, 4, true), 5),
              "lamp 0, Sky, directional: sun 2 sun 3 sun 4, rest: lamp 1 lamp 5 lamp 6");
    EXPECT_EQ(groupsOf(sceneOf(2, 2, false), 3), "directional: sun 1 sun 2, rest: lamp 0 lamp 3");
    EXPECT_EQ(groupsOf(sceneOf(5, 0, false), 3), "directional: sun 0 sun 1 sun 2 sun 3 sun 4");
}

TEST(LightGroups, NoneIsLeftAloneInTheRest) {
    EXPECT_EQ(groupsOf(sceneOf(4, 2, false), 5), "lamp 0, lamp 5, directional: sun 1 sun 2 sun 3 sun 4");
    EXPECT_EQ(groupsOf(sceneOf(4, 1, false), 3), "lamp 4, directional: sun 0 sun 1 sun 2 sun 3");
}

TEST(LightGroups, LightsKeepTheirNames) {
    Scene scene = sceneOf(0, 4, false);
    scene.lights[2].name = "rest";
    EXPECT_EQ(groupsOf(scene, 3), "lamp 0, rest 2: lamp 1 rest lamp 3");
}

} // namespace relume
