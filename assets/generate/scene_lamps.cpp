#include "assets/generate/shapes/scene_builder.h"
#include "assets/generate/shapes/furniture.h"
#include "assets/generate/generate_scenes.h"
#include "assets/generate/shapes/shapes.h"

namespace relume::generate {
namespace {

// These are half the room's edges and its height; its floor is at 0 [m].
constexpr double kRoomHalfX = 3.0, kRoomHalfZ = 2.0, kRoomHeight = 3.0;
// The window in the left wall is given in parts of the wall from its front upper corner.
constexpr double kWindowFromZ = 0.3, kWindowToZ = 0.7, kWindowFromY = 0.2, kWindowToY = 0.65;

void addWindowedRoom(SceneBuilder& builder) {
    const int white = builder.paint("White", {0.74f, 0.73f, 0.70f});
    const int wood = builder.paint("Floor", {0.42f, 0.31f, 0.22f});
    const int blue = builder.paint("Blue wall", {0.30f, 0.40f, 0.56f});
    Room walls = room({-kRoomHalfX, 0.0, -kRoomHalfZ}, {kRoomHalfX, kRoomHeight, kRoomHalfZ});
    walls.left =
        panelWithOpening({-kRoomHalfX, kRoomHeight, kRoomHalfZ}, {0, 0, -2.0 * kRoomHalfZ},
                         {0, -kRoomHeight, 0}, {kWindowFromZ, kWindowFromY}, {kWindowToZ, kWindowToY});
    builder.add("Floor", walls.floor.paint(wood));
    builder.add("Ceiling", walls.ceiling.paint(white));
    builder.add("Back wall", walls.back.paint(white));
    builder.add("Front wall", walls.front.paint(white));
    builder.add("Window wall", walls.left.paint(white));
    builder.add("Right wall", walls.right.paint(blue));
}

void addThings(SceneBuilder& builder) {
    const int grey = builder.paint("Grey", {0.52f, 0.52f, 0.54f});
    const int ochre = builder.paint("Ochre", {0.70f, 0.48f, 0.18f});
    const int stone = builder.paint("Stone", {0.66f, 0.62f, 0.55f});
    builder.add("Tall box", box({0.71, 1.43, 0.67}).turnY(17.3).paint(grey), {1.71, -kSunk, -1.13});
    builder.add("Low box", box({0.83, 0.61, 0.77}).turnY(-23.1).paint(ochre), {-0.43, -kSunk, 0.37});
    builder.add(
        "Column",
        lathe({{0.17, kRoomHeight + kSunk}, {0.17, kRoomHeight / 2}, {0.17, -kSunk}}, 32).paint(stone),
        {0.61, 0.0, -0.57});
}

// Adds an emissive tube along the back wall, like a fluorescent lamp: 1.4 klm from 0.11 m^2.
void addTube(SceneBuilder& builder) {
    const int lit = builder.lamp("Tube", {4000.0f, 4000.0f, 4000.0f});
    constexpr double kRadius = 0.02, kHalfLength = 0.45;
    Solid tube =
        lathe({{0.0, kHalfLength}, {kRadius, kHalfLength}, {kRadius, -kHalfLength}, {0.0, -kHalfLength}}, 16);
    // Its axis, Y, becomes X.
    tube.turn(glm::dmat3({0, -1, 0}, {1, 0, 0}, {0, 0, 1}));
    builder.add("Tube", tube.paint(lit).denser(2.5), {-1.87, 2.23, -kRoomHalfZ + 0.07});
}

// Adds one light of every kind. Along its axis each gives 20 to 150 lux; the sun, low behind thin clouds,
// leaves a patch of 600 lux on the floor. The comments in lm say what such a lamp gives in all.
void addEveryKindOfLight(SceneBuilder& builder) {
    Light bulb{.name = "Bulb", .type = LightType::Point};
    bulb.color = {1.0f, 0.76f, 0.50f};
    bulb.intensity = 64.0f; // 800 lm
    bulb.radius = 0.03f;
    builder.light(bulb, {1.93f, 1.87f, 1.11f}, {1.93f, 0.0f, 1.11f});

    Light spot{.name = "Spot", .type = LightType::Spot};
    spot.color = {1.0f, 0.88f, 0.72f};
    spot.intensity = 900.0f; // 430 lm in the cone
    spot.innerConeAngle = 0.26f;
    spot.outerConeAngle = 0.44f;
    spot.radius = 0.025f;
    builder.light(spot, {-0.23f, 2.81f, 1.43f}, {-0.47f, 0.6f, 0.31f});

    Light sun{.name = "Sun", .type = LightType::Directional};
    sun.color = {1.0f, 0.80f, 0.58f};
    sun.intensity = 1200.0f;
    sun.angle = 0.0093f;
    builder.light(sun, {-6.2f, 4.3f, 1.7f}, {-0.6f, 0.9f, -0.3f});

    Light panel{.name = "Panel", .type = LightType::Rectangle};
    panel.color = {0.92f, 0.96f, 1.0f};
    panel.intensity = 2000.0f; // 2260 lm
    panel.size = {1.2f, 0.3f};
    builder.light(panel, {1.17f, 2.97f, 0.31f}, {1.17f, 0.0f, 0.31f});

    Light disc{.name = "Disc", .type = LightType::Disc};
    disc.color = {1.0f, 0.62f, 0.66f};
    disc.intensity = 3500.0f; // 780 lm
    disc.radius = 0.15f;
    builder.light(disc, {2.93f, 1.57f, 0.37f}, {0.6f, 0.9f, -0.4f});
}

} // namespace

Scene lamps() {
    SceneBuilder builder;
    addWindowedRoom(builder);
    addThings(builder);
    addTube(builder);
    addEveryKindOfLight(builder);
    builder.sky({170.0f, 205.0f, 260.0f}); // 650 lux on open ground
    builder.camera("Front", {2.71f, 1.63f, 1.83f}, {-0.9f, 1.1f, -0.55f}, 62.0f);
    builder.camera("Window side", {-2.77f, 1.7f, -1.71f}, {0.9f, 1.05f, 0.35f}, 62.0f);
    return builder.build();
}

} // namespace relume::generate
