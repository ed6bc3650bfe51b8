#include "assets/generate/town/lamps.h"

#include "assets/generate/town/ground.h"

namespace relume::generate {
namespace {

const glm::vec3 kWarm(1.0f, 0.74f, 0.46f);

void addPoint(TownKit& kit, const std::string& name, float candela, const glm::dvec3& at) {
    Light light{.name = name, .type = LightType::Point};
    light.color = kWarm;
    light.intensity = candela;
    light.radius = 0.04f;
    kit.builder.light(light, glm::vec3(at), glm::vec3(at) - glm::vec3(0, 1, 0));
}

// 700 cd all around are 8,800 lm, a bright street lamp: 75 lux at the foot of its post.
constexpr float kStreetCandela = 700.0f, kWallCandela = 420.0f, kRoomCandela = 150.0f; // the last: 1,900 lm

void addLanterns(TownKit& kit) {
    const glm::dvec3 posts[] = {
        {-6.4, kPavement, 3.62}, {4.6, kPavement, 3.62}, {17.5, kPavement, 3.62}, {-20.3, 0.0, 11.3}};
    int number = 0;
    for (const glm::dvec3& at : posts) {
        const std::string name = "Lantern " + std::to_string(++number);
        kit.builder.place(kit.lantern, {.position = at});
        addPoint(kit, name, kStreetCandela, at + glm::dvec3(0, 3.3, 0));
    }
    struct Bracket {
        const char* name;
        Frame frame;
    };
    const Bracket brackets[] = {{"Arcade lamp 1", {{-22.1, 2.7, kArcadeBack}, 0}},
                                {"Arcade lamp 2", {{-13.1, 2.7, kArcadeBack}, 0}},
                                {"Arcade lamp 3", {{2.0, 2.7, kArcadeBack}, 0}},
                                {"Arcade lamp 4", {{16.6, 2.7, kArcadeBack}, 0}},
                                {"Garden lamp", {{-2.0, 2.8, -10.6}, 1}},
                                {"Alley lamp", {{-8.0, 4.2, 14.3}, 3}},
                                {"Passage lamp", {{6.0, 2.7, 9.1}, 1}},
                                {"Court lamp 1", {{2.0, 3.0, 19.6}, 1}},
                                {"Court lamp 2", {{16.0, 3.0, 19.1}, 3}}};
    for (const Bracket& bracket : brackets) {
        kit.builder.place(kit.bracketLamp, {bracket.frame.point({0, 0, 0}), bracket.frame.turn()});
        addPoint(kit, bracket.name, kWallCandela, bracket.frame.point({0.0, 0.12, 0.62}));
    }
}

void addRoomLamps(TownKit& kit) {
    addPoint(kit, "Shop lamp", kRoomCandela, {5.5, 2.7, -10.2});
    addPoint(kit, "Tavern lamp 1", kRoomCandela, {-1.6, 2.35, 7.15});
    addPoint(kit, "Tavern lamp 2", kRoomCandela, {-5.0, 2.35, 7.15});
    addPoint(kit, "Desk lamp", 45.0f, {6.25, 4.96, 25.9});
    Light disc{.name = "Study light", .type = LightType::Disc};
    disc.color = {1.0f, 0.86f, 0.66f};
    disc.intensity = 2600.0f; // 820 lm
    disc.radius = 0.18f;
    kit.builder.light(disc, {8.5f, 6.57f, 28.2f}, {8.5f, 3.7f, 28.2f});
    Light panel{.name = "Shop window light", .type = LightType::Rectangle};
    panel.color = {1.0f, 0.92f, 0.80f};
    panel.intensity = 3400.0f; // 2,700 lm
    panel.size = {1.7f, 0.15f};
    kit.builder.light(panel, {4.2f, 3.52f, -8.3f}, {4.2f, 0.9f, -8.5f});
    Light spot{.name = "Portal spot", .type = LightType::Spot};
    spot.color = {1.0f, 0.83f, 0.60f};
    spot.intensity = 9000.0f;
    spot.innerConeAngle = 0.28f;
    spot.outerConeAngle = 0.50f;
    spot.radius = 0.05f;
    kit.builder.light(spot, {26.3f, 2.1f, 0.8f}, {33.0f, 6.4f, -0.4f});
}

} // namespace

void addTownLights(TownKit& kit) {
    Light sun{.name = "Sun", .type = LightType::Directional};
    sun.color = {1.0f, 0.80f, 0.56f};
    sun.intensity = 9000.0f; // lux, an hour before it sets in haze
    sun.angle = 0.0093f;
    kit.builder.light(sun, {-40.0f, 30.0f, 19.0f}, {0.0f, 0.0f, 0.0f});
    kit.builder.sky({380.0f, 500.0f, 690.0f}); // 1,560 lux on open ground
    addLanterns(kit);
    addRoomLamps(kit);
}

void addTownCameras(SceneBuilder& builder) {
    builder.camera("Street", {-15.6f, 1.75f, 1.9f}, {8.0f, 3.4f, -1.5f}, 58.0f);
    builder.camera("Arcade", {-16.6f, 1.75f, -5.75f}, {2.0f, 1.75f, -5.6f}, 60.0f);
    builder.camera("Market", {-15.2f, 1.75f, 3.9f}, {-23.0f, 1.5f, 11.5f}, 64.0f);
    builder.camera("Alley", {-9.0f, 1.75f, 5.2f}, {-9.25f, 2.9f, 20.0f}, 62.0f);
    builder.camera("Courtyard", {14.9f, 1.75f, 23.9f}, {5.2f, 2.9f, 15.0f}, 66.0f);
    builder.camera("Tavern", {0.7f, 1.65f, 9.2f}, {-5.5f, 1.1f, 4.9f}, 64.0f);
    builder.camera("Study", {11.0f, 5.3f, 25.8f}, {7.3f, 4.5f, 30.0f}, 66.0f);
    builder.camera("Shop", {8.2f, 1.7f, -8.4f}, {4.2f, 1.2f, -11.6f}, 64.0f);
    builder.camera("Terrace", {28.6f, 3.6f, 1.6f}, {-10.0f, 2.2f, -1.2f}, 58.0f);
    builder.camera("Roofs", {-31.0f, 25.0f, 34.0f}, {2.0f, 1.0f, 3.0f}, 50.0f);
}

} // namespace relume::generate
