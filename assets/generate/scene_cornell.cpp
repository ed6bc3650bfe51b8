#include "assets/generate/shapes/scene_builder.h"
#include "assets/generate/shapes/furniture.h"
#include "assets/generate/generate_scenes.h"
#include "assets/generate/shapes/shapes.h"

#include <cmath>

namespace relume::generate {
namespace {

constexpr glm::vec3 kWhite(0.74f, 0.73f, 0.70f), kRed(0.62f, 0.07f, 0.06f), kGreen(0.12f, 0.46f, 0.12f);

Solid coneOnGround(double radius, double height, int segments) {
    std::vector<glm::dvec2> profile;
    constexpr int kRows = 5;
    for (int i = 0; i <= kRows; ++i)
        profile.emplace_back(radius * i / kRows, height * (kRows - i) / kRows);
    return lathe(profile, segments);
}

// Makes a solid of twenty triangles, whose flat facets show one tone each.
Solid icosahedron(double radius, int material) {
    const double g = (1.0 + std::sqrt(5.0)) / 2.0;
    const std::vector<glm::dvec3> v = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                       {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                       {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    const int faces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                              {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                              {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                              {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    Solid solid;
    for (const auto& face : faces) {
        std::vector<glm::dvec3> points;
        for (int corner : face)
            points.push_back(radius * glm::normalize(v[corner]));
        const glm::dvec3 right = glm::normalize(points[1] - points[0]);
        const glm::dvec3 normal = glm::normalize(glm::cross(points[1] - points[0], points[2] - points[0]));
        solid.add(polygon(points, right, glm::cross(right, normal)));
    }
    return solid.paint(material);
}

void addWalls(SceneBuilder& builder, Room walls, int white, int left, int right) {
    builder.add("Floor", walls.floor.paint(white));
    builder.add("Ceiling", walls.ceiling.paint(white));
    builder.add("Back wall", walls.back.paint(white));
    builder.add("Front wall", walls.front.paint(white));
    builder.add("Left wall", walls.left.paint(left));
    builder.add("Right wall", walls.right.paint(right));
}

} // namespace

Scene cornellSmall() {
    SceneBuilder builder;
    const int white = builder.paint("White", kWhite);
    const int red = builder.paint("Red", kRed);
    const int green = builder.paint("Green", kGreen);
    const int lit = builder.lamp("Light", {60.0f, 52.0f, 40.0f});
    Room walls = room({-1.0, 0.0, -1.0}, {1.0, 2.0, 1.0});
    // The light fills an opening: nothing hides behind it and it has no other side.
    constexpr double kEdge = 0.25, kFrom = 0.5 - kEdge / 4.0, kTo = 0.5 + kEdge / 4.0;
    walls.ceiling = panelWithOpening({-1.0, 2.0, 1.0}, {2.0, 0, 0}, {0, 0, -2.0}, {kFrom, kFrom}, {kTo, kTo});
    addWalls(builder, walls, white, red, green);
    builder.add("Light",
                quad({-kEdge / 2, 0.0, kEdge / 2}, {kEdge, 0, 0}, {0, 0, -kEdge}).paint(lit).denser(2.0),
                {0.0, 2.0, 0.0});
    builder.add("Tall box", box({0.57, 1.19, 0.59}).turnY(17.3).paint(white), {-0.37, -kSunk, -0.31});
    builder.add("Low box", box({0.61, 0.58, 0.57}).turnY(-18.1).paint(white), {0.37, -kSunk, 0.33});

    builder.camera("Front", {0.0f, 1.0f, 0.97f}, {0.0f, 0.93f, -0.5f}, 78.0f);
    return builder.build();
}

Scene cornellGeom() {
    SceneBuilder builder;
    const int white = builder.paint("White", kWhite);
    const int red = builder.paint("Red", kRed);
    const int green = builder.paint("Green", kGreen);
    const int dark = builder.paint("Dark metal", {0.18f, 0.18f, 0.2f});
    const int lit = builder.lamp("Light strip", {56.0f, 48.0f, 37.0f});
    addWalls(builder, room({-2.0, 0.0, -2.25}, {2.0, 3.0, 3.0}), white, red, green);
    builder.add("Light strip", ceilingLight({2.6, 0.14}, 0.05, lit, dark), {0.0, 3.0, -0.1});

    const int blue = builder.paint("Blue", {0.16f, 0.27f, 0.58f});
    const int yellow = builder.paint("Ochre", {0.72f, 0.48f, 0.12f});
    const int rose = builder.paint("Rose", {0.68f, 0.36f, 0.38f});
    const int teal = builder.paint("Teal", {0.10f, 0.44f, 0.44f});
    builder.add("Tall box", box({0.87, 1.63, 0.91}).turnY(19.3).paint(white), {-0.83, -kSunk, -1.07});
    builder.add("Low box", box({1.03, 0.57, 0.97}).turnY(-16.7).paint(white), {0.69, -kSunk, -0.89});
    builder.add("Sphere", sphere(0.37, 12).turnY(11.0).paint(blue).denser(1.2),
                {0.67, 0.57 - kSunk + 0.357, -0.87});
    Solid cylinder = lathe({{0.26, 0.83}, {0.26, 0.415}, {0.26, 0.0}}, 48);
    cylinder.add(cap({0.26, 0.83}, 48, true));
    builder.add("Cylinder", cylinder.paint(teal).denser(1.2), {1.53, -kSunk, 0.03});
    builder.add("Cone", coneOnGround(0.34, 0.91, 48).paint(yellow).denser(1.2), {-0.23, -kSunk, 0.07});
    const glm::dmat3 lean({0.8, 0.6, 0.0}, {-0.6, 0.8, 0.0}, {0.0, 0.0, 1.0});
    builder.add("Ring",
                torus(0.31, 0.105, 48, 20).turn(layOnWall()).turn(lean).turnY(31.0).paint(rose).denser(1.2),
                {-1.17, 0.401, 0.21});
    builder.add("Icosahedron", icosahedron(0.29, white).turnY(23.0).denser(1.2), {0.57, 0.226, 0.41});

    builder.camera("Front", {0.0f, 1.62f, 2.92f}, {0.0f, 1.15f, -0.4f}, 52.0f);
    builder.camera("Corner", {-1.75f, 2.2f, 2.3f}, {0.35f, 0.55f, -0.7f}, 50.0f);
    return builder.build();
}

Scene cornellLayers() {
    SceneBuilder builder;
    const int white = builder.paint("White", kWhite);
    const int red = builder.paint("Red", kRed);
    const int green = builder.paint("Green", kGreen);
    const int grey = builder.paint("Grey", {0.45f, 0.45f, 0.47f});
    const int blue = builder.paint("Blue", {0.18f, 0.32f, 0.60f});
    const int dark = builder.paint("Dark metal", {0.18f, 0.18f, 0.2f});
    const int lit = builder.lamp("Light", {12.5f, 11.0f, 8.8f});
    addWalls(builder, room({-2.0, 0.0, -2.1}, {2.0, 3.2, 2.3}), white, red, green);
    builder.add("Light", ceilingLight({1.5, 0.9}, 0.05, lit, dark), {0.0, 3.2, -0.7});

    // The wedge lies across the room, broad at the back wall and with an edge in front; what light there is
    // below comes around the edge. It runs through three walls, so its open ends are outside.
    const glm::dvec3 top(-2.06, 1.813, -2.16), edge(-2.06, 1.493, 0.871), base(-2.06, 1.281, -2.16);
    const glm::dvec3 across(4.12, 0, 0);
    Solid wedge = quad(top, across, edge - top);
    wedge.add(quad(edge, across, base - edge));
    builder.add("Wedge", wedge.paint(white));

    // A thin wall divides the lower layer; it ends inside the wedge, whose underside slopes.
    builder.add("Inner wall", box({0.043, 1.53, 2.17}).turnY(3.1).paint(grey), {0.417, -kSunk, -1.057});

    // Light must not get into the cell. Its inside has charts of its own.
    const glm::dvec3 inside(0.93, 0.67, 0.89);
    const double wall = 0.061;
    Solid outer = box({inside.x + 2 * wall, inside.y + 2 * wall + kSunk, inside.z + 2 * wall}).paint(blue);
    builder.add("Cell", outer.turnY(17.7), {-0.881, -kSunk, -0.507});
    const Room cell = room({-inside.x / 2, 0.0, -inside.z / 2}, {inside.x / 2, inside.y, inside.z / 2});
    Solid inner;
    for (const Solid& side : {cell.floor, cell.ceiling, cell.back, cell.front, cell.left, cell.right})
        inner.add(side);
    builder.add("Cell inside", inner.paint(white).turnY(17.7), {-0.881, wall, -0.507});

    builder.add("Block", box({0.53, 0.67, 0.49}).turnY(-21.0).paint(white), {1.213, -kSunk, -0.37});
    builder.add("Ball", sphere(0.33, 3).turnY(17.0).paint(grey).denser(1.2), {1.147, 1.927, -0.61});
    builder.add("Upper block", box({0.61, 0.59, 0.57}).turnY(27.0).paint(white), {-0.931, 1.613, -0.83});

    builder.camera("Front", {0.05f, 1.66f, 2.22f}, {0.0f, 1.57f, -1.0f}, 64.0f);
    builder.camera("Lower layer", {1.7f, 1.1f, 2.1f}, {-0.5f, 0.62f, -1.2f}, 58.0f);
    builder.camera("Inside the cell", {-0.6f, 0.6f, -0.25f}, {-1.1f, 0.3f, -0.8f}, 75.0f);
    return builder.build();
}

} // namespace relume::generate
