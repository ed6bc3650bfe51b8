#include "assets/generate/shapes/scene_builder.h"
#include "assets/generate/shapes/furniture.h"
#include "assets/generate/shapes/pixels.h"
#include "assets/generate/generate_scenes.h"
#include "assets/generate/shapes/shapes.h"

#include <cmath>

namespace relume::generate {
namespace {

constexpr double kApothem = 3.8, kWallHeight = 3.4, kPanelled = 0.93; // [m]

// Puts eight corners between the compass points; the radius of a profile is the distance to the walls.
glm::dvec3 eightSided(double angle, const glm::dvec2& radiusAndHeight) {
    return revolve(angle + kPi / 8.0, {radiusAndHeight.x / std::cos(kPi / 8.0), radiusAndHeight.y});
}

void addShell(SceneBuilder& builder) {
    const double side = 2.0 * kApothem * std::tan(kPi / 8.0);
    const int tiles = builder.textured("Floor tiles", floorTiles(), {2.4, 2.4});
    const int panels = builder.textured("Wood panelling", woodPanelling(), {side / 4.0, kPanelled});
    const int paper = builder.textured("Wallpaper", wallpaper(), {side / 4.0, side / 4.0});
    const int plaster = builder.paint("Plaster", {0.78f, 0.76f, 0.72f});
    const int darkWood = builder.paint("Dark wood", {0.22f, 0.12f, 0.07f});
    builder.add("Floor", cap({kApothem, 0.0}, 8, true, eightSided).paint(tiles));
    builder.add("Ceiling", cap({kApothem, kWallHeight}, 8, false, eightSided).paint(plaster));
    for (int i = 0; i < 8; ++i) {
        // As seen from inside, the corners run from right to left.
        const glm::dvec3 left = eightSided(kPi / 4.0 * (i + 1), {kApothem, kWallHeight});
        const glm::dvec3 right = eightSided(kPi / 4.0 * ((i + 1) % 8 - 1), {kApothem, kWallHeight});
        const glm::dvec3 across = snap(right) - snap(left);
        const glm::dvec3 down(0, kPanelled - kWallHeight, 0);
        Solid wall = quad(snap(left), across, down).paint(paper);
        wall.add(quad(snap(left) + down, across, {0, -kPanelled, 0}).paint(panels));
        builder.add("Wall " + std::to_string(i + 1), wall);
    }
    const double wall = kApothem + kSunk;
    // Profiles on the inner side of a ring run upwards.
    builder.add("Chair rail", lathe({{wall, 0.905},
                                     {kApothem - 0.021, 0.911},
                                     {kApothem - 0.045, 0.935},
                                     {kApothem - 0.045, 0.962},
                                     {wall, 0.973}},
                                    8, eightSided)
                                  .paint(darkWood));
    builder.add("Skirting",
                lathe({{kApothem - 0.027, -kSunk}, {kApothem - 0.027, 0.121}, {wall, 0.139}}, 8, eightSided)
                    .paint(darkWood));
    builder.add("Cornice", lathe({{wall, 3.09},
                                  {kApothem - 0.043, 3.113},
                                  {kApothem - 0.062, 3.173},
                                  {kApothem - 0.131, 3.241},
                                  {kApothem - 0.233, 3.297},
                                  {kApothem - 0.251, 3.343},
                                  {kApothem - 0.263, kWallHeight + kSunk}},
                                 8, eightSided)
                               .paint(plaster));
}

Solid cornerColumn() {
    return lathe({{0.185, 3.43},
                  {0.185, 3.061},
                  {0.165, 3.031},
                  {0.150, 2.972},
                  {0.121, 2.913},
                  {0.107, 2.891},
                  {0.113, 1.9},
                  {0.118, 1.2},
                  {0.121, 0.33},
                  {0.139, 0.291},
                  {0.165, 0.232},
                  {0.175, 0.17},
                  {0.185, 0.151},
                  {0.185, -kSunk}},
                 20);
}

// Makes a vessel whose walls have a thickness; its profile goes from the inner bottom over the rim down the
// outside.
Solid bowl() {
    std::vector<glm::dvec2> profile = {
        {0.0, 0.655},   {0.13, 0.662},  {0.25, 0.693},  {0.35, 0.751},  {0.42, 0.842},  {0.452, 0.951},
        {0.485, 0.957}, {0.489, 0.941}, {0.462, 0.831}, {0.39, 0.716},  {0.28, 0.637},  {0.16, 0.581},
        {0.095, 0.527}, {0.073, 0.451}, {0.083, 0.351}, {0.117, 0.271}, {0.139, 0.231}, {0.119, 0.197},
        {0.163, 0.141}, {0.227, 0.093}, {0.241, 0.057}, {0.241, -kSunk}};
    return lathe(profile, 48);
}

Solid bench(int wood) {
    Solid solid = box({1.41, 0.061, 0.38}, Bottom::Closed).move({0, 0.401, 0});
    for (double x : {-0.561, 0.561})
        solid.add(smallBox({0.071, 0.431, 0.317}).move({x, -kSunk, 0}));
    return solid.paint(wood);
}

// Makes a lit globe on an arm from the wall; the origin lies in the wall and the arm reaches towards +Z.
Solid sconce(int lit, int metal) {
    Solid solid = globe(0.101, 20, 12).turnY(9.0).move({0, 0.177, 0.217}).paint(lit).denser(2.5);
    // The globe rests in a cup whose rim stays clear of it.
    solid.add(lathe({{0.0, 0.083},
                     {0.055, 0.087},
                     {0.063, 0.097},
                     {0.066, 0.087},
                     {0.027, 0.051},
                     {0.023, 0.013},
                     {0.0, 0.003}},
                    16)
                  .move({0, -0.017, 0.217})
                  .paint(metal)
                  .denser(1.3));
    solid.add(smallBox({0.021, 0.211, 0.023}, Bottom::Closed)
                  .turn(layOnWall())
                  .move({0, 0.023, 0.0})
                  .paint(metal)
                  .denser(1.3));
    Solid plate = lathe({{0.0, 0.027}, {0.055, 0.023}, {0.069, 0.009}, {0.069, -kSunk}}, 16);
    return solid.add(plate.turn(layOnWall()).move({0, 0.021, 0}).paint(metal).denser(1.3));
}

void addLamps(SceneBuilder& builder) {
    const int brass = builder.paint("Brass", {0.62f, 0.45f, 0.17f});
    const char* names[] = {"Amber", "Azure", "Rose", "Jade"};
    const glm::vec3 colors[] = {
        {165.0f, 84.0f, 14.0f}, {14.0f, 72.0f, 170.0f}, {170.0f, 22.0f, 68.0f}, {18.0f, 128.0f, 50.0f}};
    for (int i = 0; i < 4; ++i) {
        const std::string name = "Lamp " + std::to_string(i + 1);
        const int lit = builder.lamp(name + " (" + names[i] + ")", colors[i]);
        // They are a quarter of a turn apart, on the walls that face the axes.
        const double angle = 90.0 * i;
        const glm::dvec3 wall =
            kApothem * glm::dvec3(std::sin(glm::radians(angle)), 0, std::cos(glm::radians(angle)));
        builder.add(name, sconce(lit, brass).turnY(angle + 180.0), wall + glm::dvec3(0, 1.87, 0));
    }
    const int warm = builder.lamp("Pendant", {13.0f, 11.2f, 9.0f});
    Solid pendant = globe(0.203, 28, 18).paint(warm).denser(2.0);
    pendant.add(lathe({{0.0, 0.259}, {0.061, 0.253}, {0.069, 0.217}, {0.083, 0.171}}, 16).paint(brass));
    pendant.add(lathe({{0.0131, 0.93}, {0.0131, 0.241}}, 8).paint(brass));
    pendant.add(lathe({{0.107, 0.92}, {0.099, 0.871}, {0.027, 0.843}, {0.0, 0.841}}, 16).paint(brass));
    builder.add("Pendant", pendant, {0.0, 2.493, 0.0});
}

} // namespace

Scene octagon() {
    SceneBuilder builder;
    addShell(builder);
    addLamps(builder);
    const int marble = builder.paint("Marble", {0.74f, 0.72f, 0.68f});
    const int bronze = builder.paint("Bronze", {0.30f, 0.34f, 0.26f});
    const int oak = builder.paint("Oak", {0.45f, 0.27f, 0.13f});
    const int gilt = builder.paint("Gilt frame", {0.68f, 0.50f, 0.20f});
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner = eightSided(kPi / 4.0 * i, {kApothem - 0.083, 0.0});
        builder.add("Column " + std::to_string(i + 1), cornerColumn().turnY(3.0 + 45.0 * i).paint(marble),
                    corner);
    }
    builder.add("Lower step", prism(regularPolygon(8, 1.42, 22.5), 0.163 + kSunk).paint(marble),
                {0, -kSunk, 0});
    builder.add("Upper step", prism(regularPolygon(8, 1.03, 22.5), 0.161 + kSunk).paint(marble),
                {0, 0.163 - kSunk, 0});
    builder.add("Bowl", bowl().turnY(4.0).paint(bronze).denser(1.2), {0, 0.324, 0});

    const int kinds[] = {0, 2, 3, 1};
    for (int i = 0; i < 4; ++i) {
        const double angle = 45.0 + 90.0 * i;
        const glm::dvec3 out(std::sin(glm::radians(angle)), 0, std::cos(glm::radians(angle)));
        const glm::dvec2 size(1.2, 0.9);
        const std::string number = std::to_string(i + 1);
        const int picture = builder.textured("Picture " + number, painting(kinds[i]), size);
        Solid framed = framedPicture(size, picture, gilt).turn(layOnWall());
        builder.add("Picture " + number, framed.turnY(angle + 180.0),
                    kApothem * out + glm::dvec3(0, 1.83, 0));
        builder.add("Bench " + number, bench(oak).turnY(angle), (kApothem - 0.317) * out);
    }
    builder.camera("Entrance", {0.9f, 1.62f, 3.25f}, {-0.12f, 1.42f, -0.6f}, 66.0f);
    builder.camera("Above", {-2.35f, 2.75f, -1.9f}, {0.35f, 0.9f, 0.6f}, 64.0f);
    return builder.build();
}

} // namespace relume::generate
