#include "assets/generate/town/houses.h"

#include <algorithm>
#include <cmath>

namespace relume::generate {
namespace {

constexpr double kOverhang = 0.42, kVerge = 0.16; // [m] of the roof at the eaves and at the gables
constexpr double kRoofThickness = 0.13;           // [m]
constexpr double kLap = -0.5;                     // [rad] by which ridge tiles go on below the middle
constexpr double kSeat = 0.03;                    // [m] by which walls reach into the roof
const double kTangent = std::tan(glm::radians(kTilePitch));

const std::vector<glm::dvec2> kCornice = {{0.0, 0.0},      {0.23, -0.01},  {0.23, -0.07},   {0.187, -0.1},
                                          {0.151, -0.161}, {0.113, -0.18}, {0.107, -0.261}, {0.061, -0.29},
                                          {0.047, -0.37},  {0.0, -0.39}};
const std::vector<glm::dvec2> kCourse = {{0.0, 0.11},    {0.087, 0.097}, {0.087, 0.041},
                                         {0.053, -0.01}, {0.041, -0.07}, {0.0, -0.09}};

std::vector<glm::dvec2> raised(std::vector<glm::dvec2> profile, double height) {
    for (glm::dvec2& p : profile)
        p.y += height;
    return profile;
}

// Tells whether the roof slopes down to this side.
bool isEaves(const House& house, int side) {
    return house.ridgeAlongX == (side % 2 == 0);
}

// Returns half the house's depth across the ridge.
double halfDepth(const House& house) {
    const glm::dvec2 size = house.high - house.low;
    return (house.ridgeAlongX ? size.y : size.x) / 2.0;
}

std::vector<Opening> openingsOf(const HouseSide& side) {
    std::vector<Opening> openings = side.holes;
    for (const FittingRow& row : side.rows)
        for (double x : row.xs) {
            const glm::dvec2 size = sizeOf(row.fitting);
            openings.push_back({{x - size.x / 2.0, row.bottom}, {x + size.x / 2.0, row.bottom + size.y}});
        }
    return openings;
}

// Makes the wall of a side with its gable, and the sides of its openings.
Solid sideWall(const House& house, int number) {
    const HouseSide& side = house.sides[number];
    const double width = widthOf(house, number);
    Solid solid;
    if (side.from < house.eaves) solid.add(wall({0.0, side.from}, {width, house.eaves}, openingsOf(side)));
    if (!isEaves(house, number) && side.from < kNoWall) {
        const double peak = house.eaves + width / 2.0 * kTangent;
        Solid gable = polygon({{0, house.eaves, 0}, {width, house.eaves, 0}, {width / 2.0, peak, 0}},
                              {1, 0, 0}, {0, -1, 0});
        for (ChartVertex& vertex : gable.charts[0].vertices)
            vertex.texCoord = {vertex.position.x, -vertex.position.y};
        solid.add(gable);
    }
    solid.paint(house.wall);
    for (const FittingRow& row : side.rows)
        for (double x : row.xs) {
            const glm::dvec2 size = sizeOf(row.fitting), low(x - size.x / 2.0, row.bottom);
            solid.add(mapped(reveal({low, low + size}, 0.0, -depthOf(row.fitting))).paint(house.wall));
        }
    return solid;
}

Solid trimOf(const House& house, int number) {
    const double width = widthOf(house, number);
    Solid solid;
    if (isEaves(house, number)) {
        solid.add(strip(0.0, width, raised(kCornice, house.eaves - 0.19)));
        // The plinth ends below doors and shop windows.
    }
    for (double height : house.courses)
        solid.add(strip(0.0, width, raised(kCourse, height)));
    return solid;
}

void addFittings(TownKit& kit, const House& house, int number) {
    const Frame frame = sideOf(house, number);
    for (const FittingRow& row : house.sides[number].rows)
        for (double x : row.xs) {
            const glm::dvec2 at(x - sizeOf(row.fitting).x / 2.0, row.bottom);
            fit(kit, row.fitting, frame, at);
            if (row.hasShutters) addShutters(kit, row.fitting, frame, at, house.shutter);
            if (row.hasFlowers)
                kit.builder.place(kit.flowerBox, {frame.point({x, row.bottom + 0.02, 0.08}), frame.turn()});
        }
}

// A slope lies in the frame of its eaves side: x along the eaves, its foot in front of the wall.
struct Slope {
    Frame frame;
    double width = 0.0; // [m] verges included
    double run = 0.0;   // [m] from the foot to the ridge, horizontally
    glm::dvec3 foot{0.0};
};

Slope slopeOf(const House& house, int number) {
    Slope slope;
    slope.frame = sideOf(house, number);
    slope.width = widthOf(house, number) + 2.0 * kVerge;
    slope.run = halfDepth(house) + kOverhang;
    slope.foot = {-kVerge, house.eaves - kOverhang * kTangent - kSeat, kOverhang};
    return slope;
}

// Makes a slope's upper side, its underside in front of the wall, and the edges.
Solid slopeSolid(const TownKit& kit, const Slope& slope, bool hasTiles) {
    const glm::dvec3 along(slope.width, 0, 0), up(0, slope.run * kTangent, -slope.run);
    const glm::dvec3 thick(0, kRoofThickness, 0);
    Solid solid;
    if (!hasTiles) solid.add(quad(slope.foot + thick + up, along, -up).paint(kit.paints.tiles));
    // The underside is there only where it is seen: before the wall and beyond the gables.
    const double part = kOverhang / slope.run;
    const glm::dvec3 verge(kVerge, 0, 0), inner = slope.foot + part * up;
    Solid wood = quad(slope.foot, along, part * up);
    wood.add(quad(inner, verge, (1.0 - part) * up));
    wood.add(quad(inner + along - verge, verge, (1.0 - part) * up));
    wood.add(quad(slope.foot + thick, along, -thick));      // at the eaves
    wood.add(quad(slope.foot + thick + up, -up, -thick));   // left verge
    wood.add(quad(slope.foot + thick + along, up, -thick)); // right verge
    return solid.add(wood.paint(kit.paints.timber));
}

// Makes the board along a verge that covers the sides of the tiles; `x` is its left edge on the slope.
Solid vergeBoard(const Slope& slope, double x) {
    const double c = std::cos(glm::radians(kTilePitch)), s = std::sin(glm::radians(kTilePitch));
    const glm::dmat3 tilt({1, 0, 0}, {0, c, s}, {0, -s, c});
    return block({0.0, -0.05, -slope.run / c}, {0.12, 0.115, 0.03})
        .turn(tilt)
        .move(slope.foot + glm::dvec3(x, kRoofThickness, 0));
}

void addTileRows(TownKit& kit, const Slope& slope) {
    const double cosine = std::cos(glm::radians(kTilePitch));
    const double length = slope.run / cosine;
    const int columns = static_cast<int>(std::lround(slope.width / kTileRow.x));
    const int rows = static_cast<int>(std::lround(length / kTileRow.y));
    const double scaleX = slope.width / (columns * kTileRow.x), scaleUp = length / (rows * kTileRow.y);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const double run = slope.run * j / rows;
            const glm::dvec3 at =
                slope.foot + glm::dvec3(slope.width * i / columns, kRoofThickness + run * kTangent, -run);
            kit.builder.place(kit.tileRow,
                              {slope.frame.point(at), slope.frame.turn(), {scaleX, scaleUp, scaleUp}});
        }
}

// Makes the ridge: half tiles, each over the foot of the next.
Solid ridgeSolid(const House& house, double width) {
    const double height = house.eaves + halfDepth(house) * kTangent - kSeat + kRoofThickness - 0.045;
    const int tiles = static_cast<int>(std::lround(width / 0.42));
    const int rows = 2 * tiles + 2; // the first and the last close the ends
    return grid({.columns = 6, .rows = rows},
                [&](double s, double t) {
                    const long step = std::lround(t * rows) - 1;
                    const bool isEnd = step < 0 || step > 2 * tiles;
                    const double angle = kLap + (kPi - 2.0 * kLap) * s; // its edges are within the roof
                    const double radius = isEnd ? 0.0 : step % 2 ? 0.145 : 0.165;
                    const double along = std::clamp(double((step + 1) / 2) / tiles, 0.0, 1.0);
                    const double x = width * (along - 0.5) - (step > 0 && step % 2 ? 0.012 : 0.0);
                    return glm::dvec3(x, height + radius * std::sin(angle), radius * std::cos(angle));
                })
        .turnY(house.ridgeAlongX ? 0.0 : 90.0);
}

Solid chimneySolid(const TownKit& kit, double height) {
    Solid solid = block({-0.33, -1.6, -0.27}, {0.33, height, 0.27}).paint(kit.paints.brick);
    solid.add(block({-0.39, height - 0.21, -0.33}, {0.39, height - 0.09, 0.33}).paint(kit.paints.stone));
    for (double x : {-0.16, 0.16})
        solid.add(lathe({{0.0, height + 0.35},
                         {0.071, height + 0.37},
                         {0.093, height + 0.43},
                         {0.107, height + 0.41},
                         {0.101, height + 0.31},
                         {0.117, height - 0.02}},
                        12)
                      .move({x, 0, 0})
                      .paint(kit.paints.terracotta));
    return solid;
}

void addRoof(TownKit& kit, const House& house) {
    const int first = house.ridgeAlongX ? 0 : 1;
    Solid roof;
    for (int number : {first, first + 2}) {
        const Slope slope = slopeOf(house, number);
        roof.add(slope.frame.put(slopeSolid(kit, slope, house.sides[number].hasTiles)));
        if (house.sides[number].hasTiles) {
            addTileRows(kit, slope);
            Solid boards = vergeBoard(slope, -0.02).add(vergeBoard(slope, slope.width - 0.1));
            roof.add(slope.frame.put(boards.paint(kit.paints.timber)));
        }
        if (!house.sides[number].hasCornice) {
            const int count = static_cast<int>(std::lround(slope.width / 0.62));
            for (int i = 1; i < count; ++i)
                kit.builder.place(kit.rafter, {slope.frame.point({slope.width * i / count - kVerge,
                                                                  house.eaves - kSeat, 0.0}),
                                               slope.frame.turn()});
        }
    }
    const glm::dvec2 middle = (house.low + house.high) / 2.0;
    roof.add(ridgeSolid(house, widthOf(house, first) + 2.0 * kVerge)
                 .move({middle.x, 0, middle.y})
                 .paint(kit.paints.tileRows));
    const double ridge = house.eaves + halfDepth(house) * kTangent;
    for (const glm::dvec2& at : house.chimneys) {
        const glm::dvec2 place = middle + (house.ridgeAlongX ? at : glm::dvec2(at.y, at.x));
        roof.add(chimneySolid(kit, 1.5).move({place.x, ridge - std::abs(at.y) * kTangent, place.y}));
    }
    kit.builder.add(house.name + " roof", roof);
}

} // namespace

std::vector<double> evenly(double width, int count) {
    std::vector<double> places;
    for (int i = 0; i < count; ++i)
        places.push_back(width * (i + 0.5) / count);
    return places;
}

Frame sideOf(const House& house, int side) {
    switch (side) {
    case 0:
        return {{house.low.x, 0.0, house.high.y}, 0};
    case 1:
        return {{house.high.x, 0.0, house.high.y}, 1};
    case 2:
        return {{house.high.x, 0.0, house.low.y}, 2};
    default:
        return {{house.low.x, 0.0, house.low.y}, 3};
    }
}

double widthOf(const House& house, int side) {
    return side % 2 == 0 ? house.high.x - house.low.x : house.high.y - house.low.y;
}

void addHouse(TownKit& kit, const House& house) {
    Solid walls;
    for (int side = 0; side < 4; ++side) {
        const Frame frame = sideOf(house, side);
        walls.add(frame.put(sideWall(house, side)));
        if (house.sides[side].hasCornice) walls.add(frame.put(trimOf(house, side).paint(house.trim)));
        addFittings(kit, house, side);
    }
    kit.builder.add(house.name, walls);
    addRoof(kit, house);
}

} // namespace relume::generate
