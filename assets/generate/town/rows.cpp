#include "assets/generate/town/rows.h"

#include "assets/generate/town/ground.h"
#include "assets/generate/town/houses.h"
#include "assets/generate/town/interiors.h"

namespace relume::generate {
namespace {

constexpr double kNorthBack = -14.6, kSouthBack = 14.0;

FittingRow talls(double bottom, double width, int count, bool hasFlowers = false) {
    return {Fitting::Tall, bottom, evenly(width, count), true, hasFlowers};
}

FittingRow smalls(double bottom, double width, int count) {
    return {Fitting::Small, bottom, evenly(width, count)};
}

House northern(const std::string& name, double x0, double x1, double eaves, int plaster,
               const TownPaints& paints) {
    House house;
    house.name = name;
    house.low = {x0, kNorthBack};
    house.high = {x1, kArcadeFront};
    house.eaves = eaves;
    house.wall = paints.plaster[plaster];
    house.trim = paints.stone;
    house.sides[0].from = 4.2;
    house.sides[0].hasTiles = true;
    house.sides[0].hasCornice = true;
    house.courses = {4.31};
    return house;
}

// Adds a wall of shops behind the arcade, from x0 to x1, and its two ends; `room` has openings of its own.
void addShopWall(TownKit& kit, const std::string& name, double x0, double x1,
                 const std::vector<FittingRow>& rows, const std::vector<Opening>& roomOpenings) {
    const Frame frame{{x0, 0.0, kArcadeBack}, 0};
    std::vector<Opening> openings = roomOpenings;
    Solid solid;
    for (const FittingRow& row : rows)
        for (double x : row.xs) {
            const glm::dvec2 size = sizeOf(row.fitting), low(x - size.x / 2.0, row.bottom);
            openings.push_back({low, low + size});
            solid.add(mapped(reveal(openings.back(), 0.0, -depthOf(row.fitting))));
            fit(kit, row.fitting, frame, low);
        }
    for (const Opening& o : roomOpenings)
        solid.add(mapped(reveal(o, 0.0, -kWall)));
    solid.add(wall({0.0, 0.0}, {x1 - x0, 4.02}, openings));
    solid = frame.put(solid);
    kit.builder.add(name, solid.paint(kit.paints.ashlar));
}

// Closes an end of the arcade from within; where it is open, the hole is at the same place as in the house's
// side.
constexpr double kEndFrom = 1.0, kEndTo = 2.7, kEndTop = 2.75; // [m] from the front, and height
void addArcadeEnd(TownKit& kit, const std::string& name, double x, bool facesEast, bool isOpen) {
    const double width = kArcadeFront - kArcadeBack;
    // Seen from within: facing east, the front is to the left.
    Opening hole = {{kEndFrom, kPavement}, {kEndTo, kEndTop}};
    if (!facesEast) hole = {{width - kEndTo, kPavement}, {width - kEndFrom, kEndTop}};
    std::vector<Opening> holes;
    if (isOpen) holes.push_back(hole);
    const Frame frame = facesEast ? Frame{{x, 0.0, kArcadeFront}, 1} : Frame{{x, 0.0, kArcadeBack}, 3};
    Solid solid = wall({0.0, 0.0}, {width, 4.02}, holes);
    if (isOpen) solid.add(mapped(reveal(hole, 0.0, -kWall)));
    kit.builder.add(name, frame.put(solid.paint(kit.paints.ashlar)));
}

std::vector<Opening> endHole() {
    return {{{kEndFrom, kPavement}, {kEndTo, kEndTop}}};
}

// The alley's side of a house whose front is in the west: its holes are mirrored.
std::vector<Opening> mirroredEndHole() {
    const double width = kArcadeFront - kNorthBack;
    return {{{width - kEndTo, kPavement}, {width - kEndFrom, kEndTop}}};
}

void addWesternHouses(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    House first = northern("House 1", kWestEnd, -17.2, 8.9, 0, paints);
    first.sides[0].rows = {talls(4.95, 8.8, 3, true), smalls(7.1, 8.8, 4)};
    first.sides[1].from = kNoWall;
    first.chimneys = {{-2.2, 1.4}};
    addHouse(kit, first);
    House second = northern("House 2", -17.2, -8.0, 10.2, 1, paints);
    second.sides[0].rows = {talls(4.95, 9.2, 3), talls(7.55, 9.2, 3, true)};
    second.sides[1].from = 7.4;
    second.sides[3].from = 7.8;
    second.courses = {4.31, 7.21};
    second.shutter = 1;
    second.chimneys = {{-3.0, 1.2}, {3.1, -1.1}};
    addHouse(kit, second);
    House third = northern("House 3", -8.0, -2.0, 8.4, 2, paints);
    third.sides[0].rows = {talls(5.0, 6.0, 2, true)};
    third.sides[1].rows = {smalls(5.3, 10.4, 4)};
    third.sides[1].holes = endHole();
    third.sides[3].from = kNoWall;
    third.chimneys = {{1.4, 1.0}};
    addHouse(kit, third);
    const std::vector<FittingRow> rows = {{Fitting::Shop, 0.8, {1.9, 10.9, 16.4, 22.0}},
                                          {Fitting::Door, kPavement, {6.2, 13.6, 19.3}}};
    addShopWall(kit, "Western shops", kWestEnd, -2.0, rows, {});
    addArcadeEnd(kit, "Arcade end 1", kWestEnd + 0.02, true, false);
    addArcadeEnd(kit, "Arcade end 2", -2.0 - kWall, false, true);
}

void addEasternHouses(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    House first = northern("House 4", 1.0, 9.4, 10.0, 4, paints);
    first.sides[0].rows = {talls(4.95, 8.4, 3, true), talls(7.4, 8.4, 3)};
    first.sides[1].from = 7.3;
    first.sides[3].holes = mirroredEndHole();
    first.sides[3].rows = {smalls(5.4, 10.4, 4)};
    first.courses = {4.31, 7.06};
    first.chimneys = {{0.4, 1.5}};
    addHouse(kit, first);
    House second = northern("House 5", 9.4, 15.4, 8.2, 3, paints);
    second.sides[0].rows = {talls(5.0, 6.0, 2, true)};
    second.sides[1].from = second.sides[3].from = kNoWall;
    second.shutter = 1;
    addHouse(kit, second);
    House third = northern("House 6", 15.4, 22.0, 10.0, 0, paints);
    third.sides[0].rows = {talls(4.95, 6.6, 2), smalls(7.9, 6.6, 3)};
    third.sides[1].rows = {smalls(7.9, 10.4, 3)};
    third.sides[1].holes = endHole();
    third.sides[3].from = 7.2;
    third.chimneys = {{1.8, 1.3}};
    addHouse(kit, third);
    const InnerRoom shop = {.name = "Shop",
                            .frame = {{1.0, 0.0, kArcadeBack}, 0},
                            .from = 1.2,
                            .to = 7.8,
                            .depth = 4.6,
                            .floor = kPavement,
                            .ceiling = 3.6,
                            .openings = {{{2.1, 0.8}, {4.3, 2.64}}, {{5.3, kPavement}, {6.5, 2.62}}},
                            .wall = paints.inside};
    addShopWall(kit, "Eastern shops", 1.0, 22.0,
                {{Fitting::Shop, 0.8, {10.4, 13.4, 19.0}}, {Fitting::Door, kPavement, {17.1}}},
                shop.openings);
    fit(kit, Fitting::GlazedShop, shop.frame, {2.1, 0.8});
    addShell(kit, shop);
    furnishShop(kit, shop);
    addArcadeEnd(kit, "Arcade end 3", 1.0 + kWall, true, true);
    addArcadeEnd(kit, "Arcade end 4", 22.0 - kWall, false, true);
}

// Adds walls of bricks around the garden at the end of the northern alley, and its gate.
void addGarden(TownKit& kit) {
    Solid walls = block({-2.3, -0.1, -19.3}, {-2.0, 3.2, kNorthBack - 0.01});
    walls.add(block({1.0, -0.1, -19.3}, {1.3, 3.2, kNorthBack - 0.01}));
    walls.add(block({-2.02, -0.1, -19.27}, {1.02, 3.17, -19.0}));
    walls.add(block({-2.02, -0.1, kNorthBack - 0.4}, {-1.55, 3.0, kNorthBack - 0.06}));
    walls.add(block({0.55, -0.1, kNorthBack - 0.4}, {1.02, 3.0, kNorthBack - 0.06}));
    kit.builder.add("Garden walls", walls.paint(kit.paints.brick));
    Solid gate = wall({-1.55, kPavement + 0.05}, {0.55, 2.72}).move({0, 0, kNorthBack - 0.2});
    kit.builder.add("Garden gate", gate.paint(kit.paints.grille));
}

} // namespace

void addNorthernRow(TownKit& kit) {
    addWesternHouses(kit);
    addEasternHouses(kit);
    addGarden(kit);
    House terrace;
    terrace.name = "House 7";
    terrace.low = {22.0, kNorthBack};
    terrace.high = {kEastEnd, kArcadeBack};
    terrace.eaves = 9.1;
    terrace.wall = kit.paints.plaster[2];
    terrace.trim = kit.paints.stone;
    terrace.shutter = 1;
    terrace.sides[0].rows = {
        {Fitting::Door, kTerrace, {5.2}}, {Fitting::Tall, 2.5, {7.2, 9.7}, true, true}, talls(5.7, 11.0, 4)};
    terrace.sides[0].hasCornice = true;
    terrace.sides[3].from = kNoWall;
    terrace.courses = {5.2};
    addHouse(kit, terrace);
}

namespace {

House southern(const std::string& name, double x0, double x1, double eaves, int plaster,
               const TownPaints& paints) {
    House house = northern(name, x0, x1, eaves, plaster, paints);
    house.low.y = kSouthFront;
    house.high.y = kSouthBack;
    house.sides[0] = {};
    house.sides[2].hasTiles = house.sides[2].hasCornice = true;
    house.courses = {3.75};
    return house;
}

// Makes the inside of the passage to the court: two walls, a ceiling with beams, an arch at either end.
void addPassage(TownKit& kit) {
    constexpr double kFrom = 6.0, kTo = 9.0, kTop = 3.6;
    const double length = kSouthBack - kSouthFront;
    Solid walls = Frame{{kFrom, 0, kSouthBack}, 1}.put(wall({0, 0}, {length, kTop}));
    walls.add(Frame{{kTo, 0, kSouthFront}, 3}.put(wall({0, 0}, {length, kTop})));
    walls.paint(kit.paints.ashlar);
    walls.add(quad({kFrom, kTop, kSouthBack}, {kTo - kFrom, 0, 0}, {0, 0, -length}).paint(kit.paints.planks));
    for (int i = 1; i < 10; ++i) {
        const double z = kSouthFront + length * i / 10.0;
        walls.add(block({kFrom - 0.02, kTop - 0.2, z - 0.08}, {kTo + 0.02, kTop + 0.03, z + 0.08})
                      .paint(kit.paints.timber));
    }
    kit.builder.add("Passage", walls);
    const ArchesDesc desc{
        .from = 0.0, .to = kTo - kFrom, .bays = 1, .pier = 0.4, .springing = 2.05, .top = kTop, .steps = 18};
    for (const Frame& frame : {Frame{{kFrom, 0, kSouthBack}, 0}, Frame{{kTo, 0, kSouthFront}, 2}}) {
        Solid arch = arches(desc).paint(kit.paints.ashlar);
        arch.add(archBands(desc).paint(kit.paints.stone));
        for (double x : {0.1, desc.to - 0.1})
            arch.add(block({x - 0.11, -0.1, -0.51}, {x + 0.11, desc.springing + 0.02, 0.009})
                         .paint(kit.paints.ashlar));
        kit.builder.add(frame.quarter == 0 ? "Court arch" : "Street arch", frame.put(arch));
    }
}

void addTavern(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    House house = southern("Tavern", -8.0, 2.0, 9.4, 0, paints);
    // The northern side runs from east to west: x of the side is 2 - x of the town.
    const InnerRoom room = {
        .name = "Taproom",
        .frame = sideOf(house, 2),
        .from = 0.8,
        .to = 9.4,
        .depth = 5.3,
        .floor = kPavement,
        .ceiling = 3.3,
        .openings = {{{1.6, 0.95}, {3.8, 2.79}}, {{4.4, kPavement}, {5.6, 2.6}}, {{6.3, 0.95}, {8.5, 2.79}}},
        .wall = paints.inside};
    house.sides[2].holes = {room.openings[1]};
    house.sides[2].rows = {
        {Fitting::GlazedShop, 0.95, {2.7, 7.4}}, talls(4.5, 10.0, 4, true), talls(6.75, 10.0, 4)};
    house.sides[3].rows = {smalls(5.6, 9.8, 3)};
    house.sides[1].from = 7.3;
    house.sides[0].from = 6.0;
    house.chimneys = {{-3.2, 1.1}, {2.9, -1.3}};
    addHouse(kit, house);
    kit.builder.add("Tavern doorway",
                    room.frame.put(mapped(reveal(room.openings[1], 0.0, -kWall)).paint(paints.stone)));
    addShell(kit, room);
    furnishTavern(kit, room);
}

} // namespace

void addSouthernRow(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    addTavern(kit);
    House gate = southern("Gate house", 2.0, 13.0, 8.2, 2, paints);
    gate.sides[2].holes = {{{4.0, -0.3}, {7.0, 3.6}}};
    gate.sides[0].holes = {{{4.0, -0.3}, {7.0, 3.6}}};
    gate.sides[2].rows = {{Fitting::Shop, 0.8, {2.0, 9.2}}, talls(4.5, 11.0, 4)};
    gate.sides[0].rows = {{Fitting::Tall, 0.9, {1.8, 9.2}, true}, talls(4.5, 11.0, 4, true)};
    gate.sides[1].from = gate.sides[3].from = kNoWall;
    gate.sides[0].hasCornice = true;
    gate.shutter = 1;
    gate.chimneys = {{3.0, 1.2}};
    addHouse(kit, gate);
    addPassage(kit);
    House corner = southern("Corner house", 13.0, 22.0, 9.6, 1, paints);
    corner.sides[2].rows = {{Fitting::Shop, 0.8, {2.2, 6.9}},
                            {Fitting::Door, kPavement, {4.5}},
                            talls(4.5, 9.0, 3, true),
                            talls(6.95, 9.0, 3)};
    corner.sides[0].rows = {{Fitting::Small, 4.8, {1.5}}};
    corner.sides[3].from = 7.2;
    corner.chimneys = {{-2.6, 1.4}};
    addHouse(kit, corner);
    House small = southern("Narrow house", -14.5, -10.4, 7.2, 4, paints);
    small.high.y = 16.95;
    small.ridgeAlongX = false;
    small.sides[2] = {.rows = {{Fitting::Door, kPavement, {1.2}},
                               {Fitting::Small, 1.3, {2.9}},
                               {Fitting::Tall, 4.2, {1.1, 3.0}, false, true}}};
    small.sides[3] = {
        .rows = {{Fitting::Shop, 0.75, {3.0, 8.6}}, {Fitting::Door, 0.02, {5.8}}, talls(4.1, 12.75, 5)},
        .hasTiles = true,
        .hasCornice = true};
    small.sides[1] = {.rows = {smalls(4.6, 12.75, 4)}};
    addHouse(kit, small);
    House terrace = southern("House 8", 22.0, kEastEnd, 8.8, 3, paints);
    terrace.low.y = 6.0;
    terrace.high.y = 13.9;
    terrace.sides[2].rows = {
        {Fitting::Door, kTerrace, {5.6}}, {Fitting::Tall, 2.6, {2.2, 8.6}, true, true}, talls(5.6, 11.0, 4)};
    terrace.sides[3].from = kNoWall;
    terrace.sides[2].hasTiles = false;
    terrace.courses = {5.1};
    addHouse(kit, terrace);
}

void addCourtHouses(TownKit& kit) {
    const TownPaints& paints = kit.paints;
    House west = southern("Court house west", -8.0, kCourtWest, 7.6, 3, paints);
    west.low.y = kSouthBack + 0.05;
    west.high.y = kCourtSouth;
    west.ridgeAlongX = false;
    west.sides[2] = {};
    west.sides[1] = {.rows = {{Fitting::Door, kPavement, {5.4}},
                              {Fitting::Tall, 0.9, {1.6, 8.6}, true, true},
                              talls(4.3, 10.95, 4)},
                     .hasTiles = true,
                     .hasCornice = true};
    west.sides[3] = {.rows = {{Fitting::Door, kTerrace, {7.6}}, smalls(4.9, 10.95, 3)}};
    west.courses = {3.75};
    addHouse(kit, west);
    House east = southern("Court house east", kCourtEast, 22.0, 8.0, 0, paints);
    east.low.y = kSouthBack + 0.05;
    east.high.y = kCourtSouth;
    east.ridgeAlongX = false;
    east.sides[2] = {};
    east.sides[3] = {.rows = {{Fitting::Door, kPavement, {2.4}},
                              {Fitting::Tall, 0.9, {6.4, 9.4}, true, true},
                              talls(4.4, 10.95, 4)},
                     .hasTiles = true,
                     .hasCornice = true};
    east.shutter = 1;
    addHouse(kit, east);
    House south = southern("Court house south", kCourtWest, kCourtEast, 7.2, 1, paints);
    south.low.y = kCourtSouth;
    south.high.y = 31.0;
    // Its northern side runs from east to west: x of the side is 16 - x of the town.
    const InnerRoom room = {.name = "Study",
                            .frame = sideOf(south, 2),
                            .from = 4.6,
                            .to = 10.4,
                            .depth = 4.9,
                            .floor = 3.7,
                            .ceiling = 6.6,
                            .openings = {{{5.68, 4.5}, {6.72, 6.22}}, {{8.28, 4.5}, {9.32, 6.22}}},
                            .wall = paints.wallpaper};
    south.sides[2].rows = {{Fitting::Door, kPavement, {7.0}},
                           {Fitting::Tall, 0.9, {2.2, 4.75, 9.3, 11.9}, true},
                           {Fitting::GlazedTall, 4.5, {6.2, 8.8}, true, true},
                           {Fitting::Tall, 4.5, {3.6, 11.4}, true}};
    addHouse(kit, south);
    addShell(kit, room);
    furnishStudy(kit, room);
}

} // namespace relume::generate
