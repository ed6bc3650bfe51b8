#include "assets/generate/shapes/pixels.h"
#include "assets/generate/town/ground.h"
#include "assets/generate/town/houses.h"
#include "assets/generate/town/lamps.h"
#include "assets/generate/town/props.h"
#include "assets/generate/town/rows.h"
#include "assets/generate/town/town.h"

#include <algorithm>
#include <cmath>

namespace relume::generate {
namespace {

constexpr int kSeascape = 3; // of painting(): waves

void addWestEnd(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    House west;
    west.name = "Guild house";
    west.low = {-33.0, kArcadeFront};
    west.high = {kWestEnd, 17.0};
    west.eaves = 8.2;
    west.ridgeAlongX = false;
    west.wall = paints.plaster[4];
    west.trim = paints.stone;
    west.courses = {3.75};
    west.sides[1] = {.rows = {{Fitting::Shop, 0.75, {3.4, 9.4}},
                              {Fitting::Door, 0.02, {6.4, 12.6}},
                              {Fitting::Tall, 0.9, {15.4, 18.2}, true},
                              {Fitting::Tall, 4.6, evenly(21.2, 8), true, true}},
                     .hasTiles = true,
                     .hasCornice = true};
    west.chimneys = {{-4.0, 1.4}, {5.0, -1.2}};
    addHouse(kit, west);
    House south;
    south.name = "Market house";
    south.low = {kWestEnd, 17.0};
    south.high = {-10.4, kCourtSouth};
    south.eaves = 7.9;
    south.wall = paints.plaster[2];
    south.trim = paints.stone;
    south.shutter = 1;
    south.courses = {3.75};
    south.sides[2] = {.rows = {{Fitting::Shop, 0.75, {6.3, 12.9}},
                               {Fitting::Door, 0.02, {9.5}},
                               {Fitting::Tall, 4.5, {5.6, 8.2, 10.8, 13.4}, true, true}},
                      .hasTiles = true,
                      .hasCornice = true};
    south.sides[1] = {.rows = {{Fitting::Small, 4.9, {2.0, 5.6}}}};
    south.chimneys = {{3.4, 1.3}};
    addHouse(kit, south);
    House end;
    end.name = "Alley house";
    end.low = {-12.0, kCourtSouth + 0.05};
    end.high = {-6.0, 30.0};
    end.eaves = 6.8;
    end.wall = paints.plaster[0];
    end.trim = paints.stone;
    // Its northern side shows between x = -10.4 and -8: it runs from east to west.
    end.sides[2] = {.rows = {{Fitting::Door, kTerrace, {3.1}}, {Fitting::Small, 5.0, {3.1}}}};
    addHouse(kit, end);
}

// Makes the portal: a round arch in steps, and the rose window above it.
Solid portalSolid(const TownPaints& paints) {
    Solid solid;
    for (int i = 0; i < 3; ++i) {
        const double radius = 1.35 + 0.3 * i, depth = 0.2 + 0.24 * i;
        // Its profile is swept up one side, around and down the other.
        constexpr int kArc = 20;
        const auto at = [=](double s, double out, double z) {
            const long step = std::lround(s * (kArc + 2)) - 1;
            const double angle = kPi * std::clamp(double(step) / kArc, 0.0, 1.0), r = radius + out;
            const bool isFoot = step < 0 || step > kArc;
            return glm::dvec3(-r * std::cos(angle), isFoot ? -0.05 : 2.4 + r * std::sin(angle), z);
        };
        const std::vector<glm::dvec2> profile = {{0.36, -0.02}, {0.36, depth - 0.09}, {0.3, depth - 0.06},
                                                 {0.27, depth}, {0.06, depth},        {0.0, depth - 0.05},
                                                 {0.0, -0.02}};
        const int rows = static_cast<int>(profile.size()) - 1;
        solid.add(grid({.columns = kArc + 2, .rows = rows}, [&](double s, double t) {
            const glm::dvec2& p = profile[std::lround(t * rows)];
            return at(s, p.x, p.y);
        }));
    }
    return solid.paint(paints.stone);
}

void addChurch(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    House church;
    church.name = "Church";
    church.low = {kEastEnd, kArcadeBack};
    church.high = {45.0, 6.0};
    church.eaves = 10.4;
    church.wall = paints.ashlar;
    church.trim = paints.stone;
    church.courses = {9.6};
    church.sides[3].hasCornice = true;
    addHouse(kit, church);
    const Frame front = sideOf(church, 3);
    const double middle = widthOf(church, 3) / 2.0;
    Solid portal = portalSolid(paints).move({middle, kTerrace, 0});
    portal.add(wall({middle - 1.4, kTerrace - 0.05}, {middle + 1.4, kTerrace + 2.4})
                   .move({0, 0, 0.03})
                   .paint(paints.planks));
    portal.add(wall({middle - 0.03, kTerrace}, {middle + 0.03, kTerrace + 2.4})
                   .move({0, 0, 0.045})
                   .paint(paints.iron));
    // The field above the door.
    std::vector<glm::dvec3> field;
    for (const glm::dvec2& p : arc({middle, kTerrace + 2.4}, 1.38, 0.0, 180.0, 16))
        field.emplace_back(p.x, p.y, 0.03);
    portal.add(polygon(field, {1, 0, 0}, {0, -1, 0}).paint(paints.stone));
    Solid rose = torus(1.25, 0.16, 40, 10).turn(layOnWall()).paint(paints.stone);
    for (int i = 0; i < 12; ++i) {
        const double a = kTwoPi * i / 12;
        rose.add(torus(0.24, 0.05, 16, 6)
                     .turn(layOnWall())
                     .move({0.87 * std::cos(a), 0.87 * std::sin(a), 0})
                     .paint(paints.stone));
    }
    rose.add(torus(0.42, 0.07, 24, 8).turn(layOnWall()).paint(paints.stone));
    Solid pane = cap({1.25, 0.0}, 32, true).turn(layOnWall()).paint(paints.darkGlass);
    rose.add(pane.move({0, 0, 0.02}));
    portal.add(rose.move({middle, 7.9, 0}));
    for (double x : {0.4, 13.2})
        portal.add(block({x - 0.4, -0.1, -0.05}, {x + 0.4, 10.1, 0.28}).paint(paints.ashlar));
    kit.builder.add("Church front", front.put(portal));

    House tower;
    tower.name = "Tower";
    tower.low = {34.0, -12.4};
    tower.high = {38.4, -7.9};
    tower.eaves = 17.5;
    tower.wall = paints.ashlar;
    tower.trim = paints.stone;
    tower.courses = {9.9, 14.2};
    tower.sides[3] = {.rows = {{Fitting::Tall, 14.9, {1.4, 3.1}}, {Fitting::Small, 11.8, {2.25}}},
                      .hasCornice = true};
    tower.sides[0] = {.rows = {{Fitting::Tall, 14.9, {1.35, 3.05}}, {Fitting::Small, 11.8, {2.2}}},
                      .hasTiles = true,
                      .hasCornice = true};
    addHouse(kit, tower);
}

void furnishMarket(TownKit& kit) {
    addStall(kit, "Stall 1", {-22.6, 0.0, 7.2}, 20.0, 0);
    addStall(kit, "Stall 2", {-18.2, 0.0, 7.6}, -8.0, 1);
    addStall(kit, "Stall 3", {-23.2, 0.0, 12.6}, 65.0, 2);
    addStall(kit, "Stall 4", {-10.6, kPavement, -3.75}, 0.0, 1);
    addWell(kit, {-18.4, 0.0, 12.4});
    const glm::dvec4 trees[] = {{-24.2, 0.0, 4.6, 0},         {-16.4, 0.0, 15.2, 80},
                                {-23.9, 0.0, 15.4, 200},      {-0.5, kPavement, -17.2, 40},
                                {12.6, kPavement, 17.0, 120}, {28.0, kTerrace, -6.2, 10},
                                {31.4, kTerrace, 4.4, 260}};
    for (const glm::dvec4& tree : trees) {
        const double size = 0.85 + 0.0011 * tree.w;
        kit.builder.place(kit.tree, {glm::dvec3(tree), tree.w, glm::dvec3(size)});
    }
}

struct Thing {
    glm::dvec3 at;
    double turn;
};

void place(TownKit& kit, int part, const std::vector<Thing>& things) {
    for (const Thing& thing : things)
        kit.builder.place(part, {thing.at, thing.turn});
}

void furnishStreet(TownKit& kit) {
    const double y = kPavement;
    place(kit, kit.barrel,
          {{{-7.1, y, -7.1}, 0},
           {{-6.4, y, -7.2}, 40},
           {{-6.8, y + 0.9, -7.15}, 80},
           {{1.5, y, 3.85}, 15},
           {{2.3, y, 3.82}, 70},
           {{-10.0, y, 4.7}, 30},
           {{-9.9, y, 5.5}, 75},
           {{12.2, y, 24.3}, 10},
           {{12.95, y, 24.4}, 50},
           {{9.5, y, 13.4 + 1.1}, 85},
           {{-25.4, 0, 6.4}, 20},
           {{-25.3, 0, 7.2}, 55},
           {{23.6, y, 5.4}, 35},
           {{24.4, y, 5.3}, 5},
           {{-1.5, y, -9.2}, 60}});
    place(kit, kit.crate,
          {{{-23.9, 0, 9.6}, 12},
           {{-23.2, 0, 9.9}, 40},
           {{-23.6, 0.57, 9.7}, 65},
           {{-16.9, 0, 8.9}, 5},
           {{-16.6, 0.57, 8.85}, 31},
           {{-11.9, y, -6.9}, 8},
           {{-12.6, y, -7.0}, 52},
           {{-12.2, y + 0.57, -6.95}, 20},
           {{13.4, y, 23.7}, 33},
           {{14.9, y, 15.0}, 77},
           {{0.4, y, -8.4}, 22},
           {{0.45, y, -9.3}, 61},
           {{0.4, y + 0.57, -8.8}, 3},
           {{8.6, y, 3.75}, 14},
           {{-9.9, kTerrace, 23.9}, 25}});
    place(kit, kit.bench,
          {{{-3.0, y, 3.95}, 180},
           {{14.6, y, 3.95}, 180},
           {{-9.7, y, -7.1}, 0},
           {{10.0, y, -7.1}, 0},
           {{4.2, y, 15.0}, 0},
           {{2.6, y, 21.9}, 90},
           {{31.9, kTerrace, -3.4}, 270},
           {{-20.4, 0, 16.4}, 180}});
    std::vector<Thing> planters;
    for (double x : {-24.5, -18.5, -15.5, -6.5, -3.4, 2.5, 8.5, 11.5, 17.5, 20.5})
        planters.push_back({{x, y, -3.5}, 31.0 * x});
    for (const glm::dvec3& at : {glm::dvec3(9.3, y, 3.75),
                                 {5.7, y, 3.75},
                                 {2.6, y, 16.1},
                                 {2.6, y, 24.3},
                                 {15.4, y, 17.9},
                                 {15.4, y, 24.3},
                                 {26.1, kTerrace, -6.9},
                                 {26.1, kTerrace, 5.3},
                                 {32.3, kTerrace, -2.9},
                                 {32.3, kTerrace, 2.0},
                                 {-8.5, kTerrace, 13.3},
                                 {-25.4, 0, 13.8}})
        planters.push_back({at, 47.0 * at.x});
    place(kit, kit.planter, planters);
    addFountain(kit, {7.6, kPavement, 19.6});
    addLaundry(kit, {-10.4, 6.3, 12.5}, {-8.0, 6.4, 12.7});
    addIvy(kit, "Ivy court", {{kCourtEast, kPavement, 19.9}, 3}, 0.4, 5.0, 5.6);
    addIvy(kit, "Ivy garden", {{-2.0, kPavement, -19.0}, 0}, 0.2, 2.8, 2.4);
    addIvy(kit, "Ivy alley", {{-10.4, kPavement, 10.9}, 1}, 0.3, 5.6, 4.8);
    const Frame south{{2.0, 0.0, kSouthFront}, 2}, corner{{22.0, 0.0, kSouthFront}, 2},
        gate{{13.0, 0.0, kSouthFront}, 2};
    addAwning(kit, "Awning 1", corner, 1.0, 2.4, 3.35);
    addAwning(kit, "Awning 2", corner, 5.7, 2.4, 3.35);
    addAwning(kit, "Awning 3", gate, 0.8, 2.4, 3.35);
    addAwning(kit, "Awning 4", {{kWestEnd, 0.0, 17.0}, 1}, 2.2, 2.4, 3.3);
    addBalcony(kit, "Balcony 1", south, 6.25, 4.35);
    addBalcony(kit, "Balcony 2", {{-17.2, 0.0, kArcadeFront}, 0}, 4.6, 7.4);
    addBalcony(kit, "Balcony 3", {{kCourtWest, 0.0, kCourtSouth}, 1}, 4.1, 4.12);
}

} // namespace

Scene town() {
    SceneBuilder builder;
    TownKit kit{.builder = builder, .paints = makeTownPaints(builder)};
    kit.picture = builder.textured("Seascape", painting(kSeascape), {0.96, 0.72});
    makeFittings(kit);
    makeProps(kit);
    addGround(kit);
    addArcades(kit);
    addNorthernRow(kit);
    addSouthernRow(kit);
    addCourtHouses(kit);
    addWestEnd(kit);
    addChurch(kit);
    furnishMarket(kit);
    furnishStreet(kit);
    addTownLights(kit);
    addTownCameras(builder);
    return builder.buildWithoutAtlas();
}

} // namespace relume::generate
