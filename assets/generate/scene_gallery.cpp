#include "assets/generate/shapes/scene_builder.h"
#include "assets/generate/shapes/furniture.h"
#include "assets/generate/shapes/pixels.h"
#include "assets/generate/generate_scenes.h"
#include "assets/generate/shapes/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

// The gallery is a hall with an aisle and three bays on either side. Each bay has a light, an object and
// pictures of its own.
namespace relume::generate {
namespace {

constexpr double kHallHalfLength = 7.2, kHallHalfWidth = 3.7, kHallHeight = 3.3; // [m]
constexpr double kPartitionX = 2.41, kPartitionDepth = 2.31;

struct Bay {
    glm::dvec2 middle; // (x, z)
    double towardsAisle;
    glm::vec3 light; // [cd/m^2]
    const char* colorName;
};

const std::array<Bay, 6>& bays() {
    static const std::array<Bay, 6> all = {{
        {{-4.83, -2.53}, 1.0, {184.8f, 54.6f, 42.0f}, "coral"},
        {{0.03, -2.53}, 1.0, {42.0f, 130.2f, 201.6f}, "sky"},
        {{4.81, -2.53}, 1.0, {176.4f, 130.2f, 25.2f}, "gold"},
        {{-4.79, 2.53}, -1.0, {63.0f, 172.2f, 58.8f}, "leaf"},
        {{-0.02, 2.53}, -1.0, {176.4f, 46.2f, 151.2f}, "orchid"},
        {{4.83, 2.53}, -1.0, {75.6f, 71.4f, 218.4f}, "iris"},
    }};
    return all;
}

struct GalleryPaints {
    int wall, floor, ceiling, partition, stone, frame, metal;
};

void addHall(SceneBuilder& builder, const GalleryPaints& paints) {
    Room hall =
        room({-kHallHalfLength, 0.0, -kHallHalfWidth}, {kHallHalfLength, kHallHeight, kHallHalfWidth});
    builder.add("Floor", hall.floor.paint(paints.floor));
    builder.add("Ceiling", hall.ceiling.paint(paints.ceiling));
    builder.add("North wall", hall.back.paint(paints.wall));
    builder.add("South wall", hall.front.paint(paints.wall));
    builder.add("West wall", hall.left.paint(paints.wall));
    builder.add("East wall", hall.right.paint(paints.wall));
    // Partitions begin inside the long walls. Two reach the ceiling and carry a lintel over the aisle, which
    // makes a doorway; light passes over the other two.
    for (int i = 0; i < 4; ++i) {
        const double x = i < 2 ? -kPartitionX : kPartitionX;
        const double side = i % 2 == 0 ? -1.0 : 1.0;
        const double height = i < 2 ? 2.571 : kHallHeight + 0.05;
        Solid partition = box({0.163, height + kSunk, kPartitionDepth}).paint(paints.partition);
        const glm::dvec3 place(x, -kSunk, side * (kHallHalfWidth + 0.05 - kPartitionDepth / 2));
        builder.add("Partition " + std::to_string(i + 1), partition, place);
    }
    const double aisle = 2.0 * (kHallHalfWidth + 0.05 - kPartitionDepth);
    Solid lintel =
        box({0.131, kHallHeight + 0.05 - 2.487, aisle + 0.1}, Bottom::Closed).paint(paints.partition);
    builder.add("Lintel", lintel, {kPartitionX, 2.487, 0.0});
}

void addPictures(SceneBuilder& builder, const GalleryPaints& paints) {
    struct Hanging {
        int kind;
        glm::dvec2 place; // (x, z) on the wall
        double facing;    // [degrees], 0 = +Z
    };
    const double skin = kPartitionX - 0.0815; // the partitions' faces
    const std::vector<Hanging> hangings = {
        {0, {-5.63, -kHallHalfWidth}, 0.0}, {4, {-4.07, -kHallHalfWidth}, 0.0},
        {1, {-0.71, -kHallHalfWidth}, 0.0}, {5, {0.91, -kHallHalfWidth}, 0.0},
        {3, {4.87, -kHallHalfWidth}, 0.0},  {6, {-4.93, kHallHalfWidth}, 180.0},
        {2, {0.13, kHallHalfWidth}, 180.0}, {0, {5.61, kHallHalfWidth}, 180.0},
        {5, {4.05, kHallHalfWidth}, 180.0}, {2, {-skin, -2.53}, 90.0},
        {6, {skin, -2.57}, -90.0},          {3, {-kHallHalfLength, 0.0}, 90.0},
        {4, {kHallHalfLength, 0.0}, -90.0},
    };
    std::array<int, kPaintings> materials{};
    materials.fill(-1);
    for (size_t i = 0; i < hangings.size(); ++i) {
        const Hanging& at = hangings[i];
        const glm::dvec2 size = isUpright(at.kind) ? glm::dvec2(0.75, 1.0) : glm::dvec2(1.12, 0.84);
        if (materials[at.kind] < 0) {
            Image image = painting(at.kind);
            const std::string name = "Painting " + image.name;
            materials[at.kind] = builder.textured(name, std::move(image), size);
        }
        Solid framed =
            framedPicture(size, materials[at.kind], paints.frame).turn(layOnWall()).turnY(at.facing);
        builder.add("Picture " + std::to_string(i + 1), framed, {at.place.x, 1.61, at.place.y});
    }
}

Solid knot(double radius, double tube) {
    // This is a trefoil knot: p = 2 turns about the axis, q = 3 about the core.
    const auto centre = [&](double a) {
        const double r = radius * (0.62 + 0.27 * std::cos(3.0 * a));
        return glm::dvec3(r * std::sin(2.0 * a), 0.31 * radius * std::sin(3.0 * a), r * std::cos(2.0 * a));
    };
    return grid({.columns = 16, .rows = 132, .closedS = true, .closedT = true}, [&](double s, double t) {
        const double a = 2.0 * kPi * t;
        const glm::dvec3 at = centre(a);
        const glm::dvec3 up = -glm::normalize(centre(a + 1e-3) - centre(a - 1e-3));
        const glm::dvec3 front = glm::normalize(glm::cross(glm::dvec3(at.z, 0.0, -at.x), up));
        const glm::dvec3 side = glm::cross(up, front);
        return at + tube * (std::sin(2.0 * kPi * s) * side + std::cos(2.0 * kPi * s) * front);
    });
}

Solid twistedPillar() {
    // The first row is the middle of the top; the outline is not convex.
    constexpr int kRows = 31;
    return grid({.columns = 24, .rows = kRows, .closedS = true}, [](double s, double t) {
        const double row = std::max(std::round(t * kRows) - 1.0, 0.0) / (kRows - 1);
        const double angle = 2.0 * kPi * s, height = 0.67 * (1.0 - row);
        const double radius =
            t == 0.0 ? 0.0 : 0.150 - 0.035 * (1.0 - row) + 0.028 * std::cos(4.0 * angle + 2.3);
        const double turned = angle + 2.4 * height;
        return glm::dvec3(radius * std::sin(turned), height, radius * std::cos(turned));
    });
}

Solid vase() {
    return lathe({{0.0, 0.08},
                  {0.06, 0.09},
                  {0.075, 0.31},
                  {0.062, 0.46},
                  {0.080, 0.545},
                  {0.092, 0.549},
                  {0.094, 0.541},
                  {0.077, 0.455},
                  {0.094, 0.39},
                  {0.143, 0.31},
                  {0.163, 0.23},
                  {0.151, 0.13},
                  {0.108, 0.04},
                  {0.091, 0.0}},
                 36);
}

Solid star() {
    return ball(10, [](const glm::dvec3& d) {
        const double ridge =
            std::sin(7.0 * d.x + 0.4) * std::sin(7.0 * d.y + 1.1) * std::sin(7.0 * d.z + 2.3);
        return d * (0.21 + 0.075 * ridge);
    });
}

Solid stack() {
    Solid solid = box({0.34, 0.2, 0.34}).turnY(8.0);
    solid.add(box({0.27, 0.19, 0.27}).turnY(33.0).move({0.01, 0.19, 0.0}));
    return solid.add(box({0.2, 0.18, 0.2}).turnY(64.0).move({-0.01, 0.372, 0.01}));
}

void addObjects(SceneBuilder& builder, const GalleryPaints& paints) {
    const int clay = builder.paint("Clay", {0.62f, 0.36f, 0.24f});
    const int porcelain = builder.paint("Porcelain", {0.80f, 0.79f, 0.76f});
    const int bronze = builder.paint("Bronze", {0.42f, 0.31f, 0.17f});
    const glm::dmat3 leaning = layOnWall();
    const double top = 0.95;
    struct Exhibit {
        const char* name;
        Solid solid;
        int material;
        double lift; // of its origin above the plinth [m]
    };
    std::vector<Exhibit> exhibits;
    exhibits.push_back({"Ring", torus(0.19, 0.071, 36, 16).turn(leaning), porcelain, 0.251});
    exhibits.push_back({"Knot", knot(0.31, 0.052).turn(leaning), bronze, 0.292});
    exhibits.push_back({"Vase", vase(), clay, -0.0087});
    exhibits.push_back({"Star", star(), porcelain, 0.197});
    exhibits.push_back({"Pillar", twistedPillar(), clay, -kSunk});
    exhibits.push_back({"Stack", stack(), porcelain, -kSunk});
    for (size_t i = 0; i < exhibits.size(); ++i) {
        const Bay& bay = bays()[i];
        // It stands a little off the light's axis, towards the aisle.
        const glm::dvec3 place(bay.middle.x + 0.09, 0.0, bay.middle.y + 0.53 * bay.towardsAisle);
        const double turn = 17.0 + 23.0 * static_cast<double>(i);
        builder.add("Plinth " + std::to_string(i + 1), plinth(0.233, top).turnY(turn).paint(paints.stone),
                    place);
        Exhibit& exhibit = exhibits[i];
        builder.add(exhibit.name, exhibit.solid.turnY(turn).paint(exhibit.material).denser(1.4),
                    place + glm::dvec3(0.0, top + exhibit.lift, 0.0));
    }
    const int leather = builder.paint("Leather", {0.28f, 0.07f, 0.06f});
    for (int i = 0; i < 2; ++i) {
        Solid bench = smallBox({1.61, 0.113, 0.53}, Bottom::Closed).move({0, 0.321, 0}).paint(leather);
        for (double x : {-0.613, 0.613})
            bench.add(smallBox({0.087, 0.347, 0.433}).move({x, -kSunk, 0}).paint(paints.metal));
        builder.add("Bench " + std::to_string(i + 1), bench.turnY(3.0), {i == 0 ? -4.71 : 4.69, 0.0, 0.07});
    }
}

void addLights(SceneBuilder& builder, const GalleryPaints& paints) {
    int number = 0;
    const auto lamp = [&](const char* color, const glm::vec3& emission, const glm::dvec3& place,
                          double size) {
        const std::string name = "Lamp " + std::to_string(++number);
        const int lit = builder.lamp(name + " (" + color + ")", emission);
        builder.add(name, ceilingLight({size, size}, 0.043, lit, paints.metal).turnY(4.0 * number), place);
    };
    for (const Bay& bay : bays())
        lamp(bay.colorName, bay.light, {bay.middle.x, kHallHeight, bay.middle.y}, 0.271);
    for (double x : {-5.93, -3.51, -1.13, 1.17, 3.61, 5.89})
        lamp("warm white", {109.2f, 94.5f, 73.5f}, {x, kHallHeight, 0.0}, 0.157);
    // Two small ones hang above the pictures at the ends.
    lamp("pink", {147.0f, 71.4f, 92.4f}, {-6.71, kHallHeight, 0.03}, 0.133);
    lamp("mint", {63.0f, 151.2f, 105.0f}, {6.73, kHallHeight, -0.03}, 0.133);
}

} // namespace

Scene gallery() {
    SceneBuilder builder;
    GalleryPaints paints{};
    paints.wall = builder.paint("Wall", {0.76f, 0.75f, 0.72f});
    paints.floor = builder.paint("Oak floor", {0.44f, 0.30f, 0.18f});
    paints.ceiling = builder.paint("Ceiling", {0.80f, 0.80f, 0.79f});
    paints.partition = builder.paint("Partition", {0.70f, 0.69f, 0.66f});
    paints.stone = builder.paint("Plinth", {0.66f, 0.65f, 0.63f});
    paints.frame = builder.paint("Frame", {0.12f, 0.09f, 0.07f});
    paints.metal = builder.paint("Metal", {0.20f, 0.20f, 0.21f});
    addHall(builder, paints);
    addPictures(builder, paints);
    addObjects(builder, paints);
    addLights(builder, paints);
    builder.camera("Aisle", {-6.95f, 1.85f, 0.75f}, {-1.0f, 1.35f, -0.55f}, 64.0f);
    builder.camera("Bays", {1.75f, 1.95f, 1.15f}, {-1.7f, 1.2f, -2.6f}, 66.0f);
    return builder.build();
}

} // namespace relume::generate
