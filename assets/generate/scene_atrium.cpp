#include "assets/generate/shapes/scene_builder.h"
#include "assets/generate/shapes/furniture.h"
#include "assets/generate/generate_scenes.h"
#include "assets/generate/shapes/shapes.h"

#include <algorithm>
#include <cmath>

// The atrium is a court of five by three bays with an arcade around it on two storeys, a gallery behind each
// and a skylight above all.
namespace relume::generate {
namespace {

constexpr double kBay = 2.6, kHalfX = 6.5, kHalfZ = 3.9; // [m] the columns' axes
constexpr double kDepth = 2.6;                           // [m] of the galleries
constexpr double kWallHalf = 0.25;                       // [m] half the thickness of the arcades
constexpr double kPierHalf = 0.3;                        // [m] half the wall between two arches
constexpr double kSpringing = 3.0, kCeiling = 4.35;      // [m] ground floor
constexpr double kUpperFloor = 4.6, kKerb = 4.63;
constexpr double kUpperSpringing = 6.9, kUpperCeiling = 8.2;
constexpr double kSkylight = 9.3;

const glm::dvec2 kCourt(kHalfX - kWallHalf, kHalfZ - kWallHalf); // half size of the court between the arcades

struct AtriumPaints {
    int stone, shaft, plaster, lowerWall, upperWall, floor, galleryFloor, upperFloor, metal;
};

// This is one ring of a column. `square` is 0 for a round one and 1 for a square of half side `radius`.
struct Ring {
    double radius, height;
    bool square = false;
};

struct ColumnDesc {
    double height, radius; // [m] without and with its foot; of the shaft below
    int flutes, shaftRows;
};

// Returns the rings from the abacus down to the plinth; below and above the shaft, measures are in shaft
// radii.
std::vector<Ring> columnRings(const ColumnDesc& desc) {
    const double r = desc.radius, h = desc.height;
    std::vector<Ring> rings = {{0.0, h + kSunk},

                               {1.46 * r, h + kSunk, true},
                               {1.46 * r, h - 0.26 * r, true},
                               {1.38 * r, h - 0.40 * r, true}};
    const auto add = [&](const std::vector<glm::dvec2>& points) {
        for (const glm::dvec2& p : points)
            rings.push_back({p.x, p.y});
    };
    const double neck = h - 1.05 * r;
    add(arc({0.93 * r, neck + 0.28 * r}, 0.36 * r, 82.0, -72.0, 3)); // echinus
    add({{0.88 * r, neck - 0.10 * r}});
    add(arc({0.86 * r, neck - 0.20 * r}, 0.085 * r, 80.0, -80.0, 2)); // astragal
    const double low = 1.02 * r, high = neck - 0.36 * r;
    for (int i = 0; i <= desc.shaftRows; ++i) {
        const double t = static_cast<double>(i) / desc.shaftRows;
        // The shaft has entasis: it narrows by 15 %, faster towards the top.
        rings.push_back({r * (1.0 - 0.15 * std::pow(1.0 - t, 1.6)), high + (low - high) * t});
    }
    add(arc({1.08 * r, 0.84 * r}, 0.10 * r, 75.0, -75.0, 2)); // the foot: two rolls and a hollow
    add({{1.10 * r, 0.69 * r}});
    add(arc({1.20 * r, 0.52 * r}, 0.15 * r, 80.0, -85.0, 2));
    for (const Ring& ring : {Ring{1.44 * r, 0.36 * r, true}, Ring{1.44 * r, -kSunk, true}})
        rings.push_back(ring);
    return rings;
}

Solid column(const ColumnDesc& desc) {
    const std::vector<Ring> rings = columnRings(desc);
    const int rows = static_cast<int>(rings.size()) - 1;
    const double low = 1.02 * desc.radius, high = desc.height - 1.41 * desc.radius;
    return grid({.columns = 4 * desc.flutes, .rows = rows, .closedS = true}, [&](double s, double t) {
        const Ring& ring = rings[std::lround(t * rows)];
        const double angle = 2.0 * kPi * s;
        const double c = std::abs(std::cos(angle)), si = std::abs(std::sin(angle));
        double radius = ring.square ? ring.radius / std::max(c, si) : ring.radius;
        // Flutes run out at both ends of the shaft.
        const double fade = smooth(low, low + 0.4 * desc.radius, ring.height) *
                            smooth(high, high - 0.4 * desc.radius, ring.height);
        radius -= fade * 0.062 * desc.radius * std::abs(std::sin(0.5 * desc.flutes * angle));
        return glm::dvec3(radius * std::sin(angle), ring.height, radius * std::cos(angle));
    });
}

// Holds the lower edge of an arcade: corners in x on the court's side and on the gallery's, and the height of
// each.
struct Edge {
    std::vector<double> court, outer, height;
};

Edge arcadeEdge(int bays, double springing, int steps) {
    const double half = kBay * bays / 2.0;
    Edge edge;
    const auto add = [&](double court, double outer, double height) {
        edge.court.push_back(court);
        edge.outer.push_back(outer);
        edge.height.push_back(height);
    };
    add(-half + kWallHalf, -half - kWallHalf, springing); // mitred with the next side
    for (int bay = 0; bay < bays; ++bay) {
        const double middle = -half + kBay * (bay + 0.5), radius = kBay / 2.0 - kPierHalf;
        for (int i = 0; i <= steps; ++i) {
            const double angle = kPi * i / steps;
            const double x = middle - radius * std::cos(angle);
            add(x, x, i == 0 || i == steps ? springing : springing + radius * std::sin(angle));
        }
    }
    add(half - kWallHalf, half + kWallHalf, springing);
    return edge;
}

// Makes a wall on arches along X through the origin, with the court towards +Z. Its ends are open: four of
// them close a ring.
Solid arcade(int bays, double springing, double top) {
    const Edge edge = arcadeEdge(bays, springing, 20);
    const int columns = static_cast<int>(edge.height.size()) - 1;
    Solid solid = grid({.columns = columns}, [&](double s, double t) {
        const size_t i = std::lround(s * columns);
        return glm::dvec3(edge.court[i], t == 0.0 ? top : edge.height[i], kWallHalf);
    });
    solid.add(grid({.columns = columns}, [&](double s, double t) {
        const size_t i = columns - std::lround(s * columns);
        return glm::dvec3(edge.outer[i], t == 0.0 ? top : edge.height[i], -kWallHalf);
    }));
    return solid.add(grid({.columns = columns}, [&](double s, double t) {
        const size_t i = std::lround(s * columns);
        return glm::dvec3(t == 0.0 ? edge.court[i] : edge.outer[i], edge.height[i],
                          t == 0.0 ? kWallHalf : -kWallHalf);
    }));
}

// Makes the raised bands around the arches of one side, towards the court. Their ends rest inside the
// columns' heads.
Solid archivolts(int bays, double springing) {
    const std::vector<glm::dvec2> profile = {{1.163, 0.241}, {1.163, 0.287}, {1.131, 0.298},
                                             {1.107, 0.279}, {1.027, 0.284}, {1.019, 0.241}};
    const int rows = static_cast<int>(profile.size()) - 1;
    constexpr int kColumns = 20;
    Solid solid;
    for (int bay = 0; bay < bays; ++bay) {
        const double middle = kBay * (bay + 0.5 - bays / 2.0);
        solid.add(grid({.columns = kColumns, .rows = rows}, [&](double s, double t) {
            const glm::dvec2 p = profile[std::lround(t * rows)];
            const double angle = kPi * s;
            const double height = s == 0.0 || s == 1.0 ? -0.0047 : p.x * std::sin(angle);
            return glm::dvec3(middle - p.x * std::cos(angle), springing + height, p.y);
        }));
    }
    return solid;
}

struct Side {
    const char* name;
    double turn; // [degrees]
    glm::dvec3 place;
    int bays;
};
const Side kSides[4] = {{"north", 0.0, {0, 0, -kHalfZ}, 5},
                        {"south", 180.0, {0, 0, kHalfZ}, 5},
                        {"west", 90.0, {-kHalfX, 0, 0}, 3},
                        {"east", -90.0, {kHalfX, 0, 0}, 3}};

std::vector<glm::dvec2> columnPlaces() {
    std::vector<glm::dvec2> places;
    for (int i = 0; i <= 5; ++i)
        for (double z : {-kHalfZ, kHalfZ})
            places.emplace_back(-kHalfX + kBay * i, z);
    for (int i = 1; i <= 2; ++i)
        for (double x : {-kHalfX, kHalfX})
            places.emplace_back(x, -kHalfZ + kBay * i);
    return places;
}

void addArcades(SceneBuilder& builder, const AtriumPaints& paints) {
    for (const Side& side : kSides) {
        const std::string name = side.name;
        // The lower arcade's top is hidden by the floor above it and its string course.
        Solid lower = arcade(side.bays, kSpringing, kCeiling + 0.1).add(archivolts(side.bays, kSpringing));
        builder.add("Lower arcade " + name, lower.turnY(side.turn).paint(paints.stone), side.place);
        Solid upper = arcade(side.bays, kUpperSpringing, kUpperCeiling + 0.3)
                          .add(archivolts(side.bays, kUpperSpringing));
        builder.add("Upper arcade " + name, upper.turnY(side.turn).paint(paints.stone), side.place);
    }
    int number = 0;
    for (const glm::dvec2& place : columnPlaces()) {
        const std::string suffix = std::to_string(++number);
        Solid lower = column({.height = kSpringing, .radius = 0.217, .flutes = 20, .shaftRows = 5});
        builder.add("Lower column " + suffix, lower.paint(paints.shaft), {place.x, 0.0, place.y});
        Solid upper =
            column({.height = kUpperSpringing - kKerb, .radius = 0.213, .flutes = 16, .shaftRows = 4});
        builder.add("Upper column " + suffix, upper.paint(paints.shaft), {place.x, kKerb, place.y});
    }
}

Solid ringFloor(const glm::dvec2& outerHalf, const glm::dvec2& innerHalf, double height, bool up) {
    const glm::dvec2 from = (outerHalf - innerHalf) / (2.0 * outerHalf);
    const double z = up ? -outerHalf.y : outerHalf.y;
    return panelWithOpening({-outerHalf.x, height, z}, {2 * outerHalf.x, 0, 0}, {0, 0, -2 * z}, from,
                            1.0 - from);
}

Solid fourWalls(const glm::dvec2& half, double low, double high) {
    const Room shell = room({-half.x, low, -half.y}, {half.x, high, half.y});
    Solid solid = shell.back;
    return solid.add(shell.front).add(shell.left).add(shell.right);
}

void addShell(SceneBuilder& builder, const AtriumPaints& paints) {
    const glm::dvec2 half(kHalfX + kDepth, kHalfZ + kDepth);
    const glm::dvec2 axis(kHalfX, kHalfZ);
    builder.add("Gallery floor", ringFloor(half, axis, 0.0, true).paint(paints.galleryFloor));
    builder.add("Court floor",
                quad({-axis.x, 0, -axis.y}, {2 * axis.x, 0, 0}, {0, 0, 2 * axis.y}).paint(paints.floor));
    builder.add("Lower walls", fourWalls(half, 0.0, kCeiling).paint(paints.lowerWall));
    builder.add("Upper walls", fourWalls(half, kUpperFloor, kUpperCeiling).paint(paints.upperWall));
    builder.add("Lower ceiling", ringFloor(half, axis, kCeiling, false).paint(paints.plaster));
    builder.add("Upper floor", ringFloor(half, axis + 0.15, kUpperFloor, true).paint(paints.upperFloor));
    builder.add("Upper ceiling", ringFloor(half, axis, kUpperCeiling, false).paint(paints.plaster));

    // Rings seen from inside run upwards: from the arcade's face out into the court and back over the floor's
    // edge.
    builder.add("String course", moulding(kCourt, {{0.03, 4.283},
                                                   {-0.041, 4.297},
                                                   {-0.073, 4.361},
                                                   {-0.073, 4.417},
                                                   {-0.127, 4.463},
                                                   {-0.151, 4.517},
                                                   {-0.151, kKerb},
                                                   {0.561, kKerb},
                                                   {0.561, kUpperFloor - kSunk}})
                                     .paint(paints.stone));
    builder.add("Skirting",
                moulding(half, {{-0.031, -kSunk}, {-0.031, 0.163}, {kSunk, 0.187}}).paint(paints.stone));
    for (int i = 0; i < 20; ++i) {
        const bool alongX = i < 12;
        const double at = alongX ? -kHalfX + kBay * (i / 2) : -kHalfZ + kBay * ((i - 12) / 2);
        const double side = i % 2 == 0 ? -1.0 : 1.0;
        const glm::dvec3 place =
            alongX ? glm::dvec3(at, -kSunk, side * half.y) : glm::dvec3(side * half.x, -kSunk, at);
        Solid pilaster =
            smallBox({0.463, kCeiling + 0.03, 0.187}).turnY(alongX ? 0.0 : 90.0).paint(paints.stone);
        builder.add("Pilaster " + std::to_string(i + 1), pilaster, place);
    }
}

void addSkylight(SceneBuilder& builder, const AtriumPaints& paints) {
    const double inset = 0.3125;
    builder.add("Cornice", moulding(kCourt, {{0.03, 8.107},
                                             {-0.033, 8.121},
                                             {-0.061, 8.203},
                                             {-0.119, 8.261},
                                             {-0.203, 8.317},
                                             {-0.241, 8.401},
                                             {-0.241, 8.463},
                                             {-inset, 8.521},
                                             {-inset, kSkylight}})
                               .paint(paints.stone));
    const glm::dvec2 half = kCourt - inset;
    const int sky = builder.lamp("Skylight", {3.3f, 3.6f, 4.1f});
    builder.add("Skylight",
                quad({-half.x, kSkylight, half.y}, {2 * half.x, 0, 0}, {0, 0, -2 * half.y}).paint(sky));
    int number = 0;
    const auto beam = [&](const glm::dvec3& size, const glm::dvec3& place) {
        builder.add("Beam " + std::to_string(++number), smallBox(size, Bottom::Closed).paint(paints.metal),
                    place);
    };
    for (double z : {-1.13, 1.13})
        beam({2 * half.x + 0.1, 0.187, 0.101}, {0, 9.047, z});
    for (double x : {-4.81, -2.89, -0.97, 0.97, 2.89, 4.81})
        beam({0.083, 0.151, 2 * half.y + 0.1}, {x, 9.069, 0});
}

Solid baluster(double height) {
    const double h = height;
    return lathe({{0.047, h},
                  {0.047, h - 0.037},
                  {0.031, h - 0.053},
                  {0.029, h - 0.129},
                  {0.043, h - 0.227},
                  {0.067, 0.211},
                  {0.061, 0.151},
                  {0.037, 0.087},
                  {0.035, 0.061},
                  {0.055, 0.043},
                  {0.055, 0.0}},
                 12);
}

void addBalustrade(SceneBuilder& builder, const AtriumPaints& paints) {
    const glm::dvec2 axis(kHalfX, kHalfZ);
    const double low = kKerb + 0.071, high = kKerb + 0.781;
    // Both rails run through the columns' feet and shafts; the handrail's underside is part of its ring.
    Solid rails = moulding(axis, {{-0.083, kKerb - kSunk},
                                  {-0.083, low - 0.013},
                                  {-0.071, low},
                                  {0.071, low},
                                  {0.083, low - 0.013},
                                  {0.083, kKerb - kSunk}});
    rails.add(moulding(axis, {{0.0, high},
                              {-0.073, high},
                              {-0.101, high + 0.027},
                              {-0.101, high + 0.081},
                              {-0.083, high + 0.103},
                              {0.083, high + 0.103},
                              {0.101, high + 0.081},
                              {0.101, high + 0.027},
                              {0.073, high},
                              {0.0, high}}));
    builder.add("Rails", rails.paint(paints.stone));
    constexpr int kPerBay = 6;
    for (const Side& side : kSides) {
        Solid row;
        for (int bay = 0; bay < side.bays; ++bay)
            for (int i = 0; i < kPerBay; ++i) {
                const double x =
                    kBay * (bay - side.bays / 2.0) + kBay / 2.0 + 0.297 * (i - (kPerBay - 1) / 2.0);
                row.add(baluster(high - low + 2 * kSunk).turnY(7.0 * i).move({x, low - kSunk, 0}));
            }
        builder.add(std::string("Balusters ") + side.name, row.turnY(side.turn).paint(paints.stone),
                    side.place);
    }
}

void addLamps(SceneBuilder& builder, const AtriumPaints& paints) {
    const double x = kHalfX + kDepth / 2.0, z = kHalfZ + kDepth / 2.0;
    const glm::dvec3 places[] = {{-x, 0, -z}, {-2.61, 0, -z}, {2.59, 0, -z}, {x, 0, -z}, {x, 0, 0.03},
                                 {x, 0, z},   {2.61, 0, z},   {-2.59, 0, z}, {-x, 0, z}, {-x, 0, -0.03},
                                 {-x, 1, -z}, {x, 1, -z},     {x, 1, z},     {-x, 1, z}};
    int number = 0;
    for (const glm::dvec3& at : places) {
        const std::string name = "Lamp " + std::to_string(++number);
        const int lit =
            builder.lamp(name, at.y > 0.0 ? glm::vec3(36.0f, 27.0f, 16.0f) : glm::vec3(52.0f, 33.0f, 15.0f));
        Solid lamp = globe(0.137, 20, 12).turnY(5.0 * number).paint(lit).denser(1.8);
        lamp.add(
            lathe({{0.0, 0.187}, {0.043, 0.181}, {0.051, 0.151}, {0.067, 0.113}}, 12).paint(paints.metal));
        lamp.add(lathe({{0.0117, 0.97}, {0.0117, 0.173}}, 6).paint(paints.metal));
        builder.add(name, lamp, {at.x, (at.y > 0.0 ? kUpperCeiling : kCeiling) - 0.953, at.z});
    }
}

Solid fountain() {
    return lathe({{0.0, 1.43},    {0.047, 1.41},  {0.063, 1.35},  {0.041, 1.29},  {0.053, 1.17},
                  {0.17, 1.143},  {0.37, 1.187},  {0.55, 1.271},  {0.583, 1.263}, {0.571, 1.231},
                  {0.41, 1.123},  {0.23, 1.061},  {0.107, 1.01},  {0.083, 0.93},  {0.093, 0.79},
                  {0.137, 0.64},  {0.151, 0.53},  {0.113, 0.43},  {0.187, 0.361}, {0.207, 0.307},
                  {1.21, 0.283},  {1.27, 0.463},  {1.31, 0.487},  {1.43, 0.487},  {1.471, 0.457},
                  {1.463, 0.417}, {1.383, 0.371}, {1.361, 0.187}, {1.441, 0.141}, {1.463, -kSunk}},
                 56);
}

void addCourt(SceneBuilder& builder, const AtriumPaints& paints) {
    const int basin = builder.paint("Green marble", {0.24f, 0.36f, 0.30f});
    builder.add("Fountain", fountain().turnY(2.0).paint(basin), {0.0, 0.0, 0.0});
    const int leaves = builder.paint("Leaves", {0.16f, 0.32f, 0.09f});
    const int clay = builder.paint("Terracotta", {0.60f, 0.29f, 0.16f});
    int number = 0;
    for (const glm::dvec2& at : {glm::dvec2(-4.31, -2.07), {4.29, -2.03}, {4.33, 2.05}, {-4.27, 2.09}}) {
        const std::string suffix = std::to_string(++number);
        Solid pot = lathe({{0.0, 0.493},
                           {0.287, 0.483},
                           {0.297, 0.557},
                           {0.343, 0.563},
                           {0.351, 0.497},
                           {0.317, 0.477},
                           {0.297, 0.387},
                           {0.223, 0.113},
                           {0.217, 0.063},
                           {0.241, 0.047},
                           {0.241, -kSunk}},
                          28);
        builder.add("Pot " + suffix, pot.turnY(3.0 * number).paint(clay), {at.x, 0.0, at.y});
        Solid tree = ball(9, [](const glm::dvec3& d) {
            const double tuft =
                std::sin(13.0 * d.x + 1.0) * std::sin(13.0 * d.y + 2.0) * std::sin(13.0 * d.z + 3.0);
            return d * (0.457 + 0.053 * tuft);
        });
        tree.move({0, 1.513, 0}).turnY(31.0 * number).paint(leaves);
        tree.add(lathe({{0.037, 1.21}, {0.043, 0.461}}, 8).paint(paints.metal));
        builder.add("Tree " + suffix, tree, {at.x, 0.0, at.y});
    }
}

} // namespace

Scene atrium() {
    SceneBuilder builder;
    AtriumPaints paints{};
    paints.stone = builder.paint("Limestone", {0.72f, 0.66f, 0.56f});
    paints.shaft = builder.paint("Rose marble", {0.68f, 0.54f, 0.47f});
    paints.plaster = builder.paint("Plaster", {0.78f, 0.76f, 0.72f});
    paints.lowerWall = builder.paint("Terracotta wall", {0.64f, 0.36f, 0.20f});
    paints.upperWall = builder.paint("Blue wall", {0.34f, 0.46f, 0.56f});
    paints.floor = builder.paint("Court floor", {0.58f, 0.53f, 0.46f});
    paints.galleryFloor = builder.paint("Gallery floor", {0.40f, 0.31f, 0.25f});
    paints.upperFloor = builder.paint("Upper floor", {0.46f, 0.30f, 0.19f});
    paints.metal = builder.paint("Iron", {0.14f, 0.14f, 0.15f});
    addShell(builder, paints);
    addArcades(builder, paints);
    addBalustrade(builder, paints);
    addSkylight(builder, paints);
    addLamps(builder, paints);
    addCourt(builder, paints);
    builder.camera("Court", {-5.75f, 1.72f, 0.31f}, {0.6f, 2.95f, -1.35f}, 72.0f);
    builder.camera("Upper gallery", {-7.35f, 6.4f, 0.21f}, {0.5f, 3.6f, -0.75f}, 66.0f);
    builder.camera("Lower gallery", {-6.6f, 1.7f, 5.3f}, {1.5f, 1.9f, 4.1f}, 62.0f);
    return builder.build();
}

} // namespace relume::generate
