#include "assets/generate/town/ground.h"

#include <cmath>

namespace relume::generate {
namespace {

struct Area {
    double x0, z0, x1, z1, height;
};

Solid floorOf(const Area& area) {
    return mapped(
        quad({area.x0, area.height, area.z0}, {area.x1 - area.x0, 0, 0}, {0, 0, area.z1 - area.z0}));
}

// Makes a slab's side between two heights, facing left of the way from `from` to `to` (x, z).
Solid edgeOf(const glm::dvec2& from, const glm::dvec2& to, double low, double high) {
    return mapped(quad({from.x, high, from.y}, {to.x - from.x, 0, to.y - from.y}, {0, low - high, 0}));
}

void addStreet(TownKit& kit) {
    constexpr int kColumns = 48, kRows = 10;
    const double x1 = 22.0, camber = 0.07;
    Solid street = grid({.columns = kColumns, .rows = kRows}, [&](double s, double t) {
        const double z = kStreetHalf * (2.0 * t - 1.0), rest = 1.0 - z * z / (kStreetHalf * kStreetHalf);
        return glm::dvec3(kWestEnd + (x1 - kWestEnd) * s, camber * rest, z);
    });
    kit.builder.add("Street", street.paint(kit.paints.cobbles));
    Solid market = floorOf({kWestEnd, kStreetHalf, -14.5, 17.0, 0.0});
    kit.builder.add("Market", market.paint(kit.paints.cobbles));

    Solid north = floorOf({kWestEnd, kArcadeBack, 22.0, -kStreetHalf, kPavement});
    north.add(floorOf({-2.0, -19.0, 1.0, kArcadeBack, kPavement}));
    kit.builder.add("Northern pavement", north.paint(kit.paints.flags));
    Solid south = floorOf({-14.5, kStreetHalf, 22.0, kSouthFront, kPavement});
    south.add(floorOf({-10.4, kSouthFront, -8.0, 9.0, kPavement}));
    south.add(floorOf({6.0, kSouthFront, 9.0, kCourtNorth, kPavement}));
    south.add(edgeOf({-14.5, kStreetHalf}, {-14.5, kSouthFront}, -0.05, kPavement));
    kit.builder.add("Southern pavement", south.paint(kit.paints.flags));
    const Solid court = floorOf({kCourtWest, kCourtNorth, kCourtEast, kCourtSouth, kPavement});
    kit.builder.add("Courtyard", Solid(court).paint(kit.paints.cobbles));

    // Kerbs stand a little above the pavement.
    Solid kerbs =
        block({kWestEnd, -0.1, -kStreetHalf - 0.02}, {22.0, kPavement + 0.013, -kStreetHalf + 0.17});
    kerbs.add(block({-14.52, -0.1, kStreetHalf - 0.17}, {22.0, kPavement + 0.013, kStreetHalf + 0.02}));
    kit.builder.add("Kerbs", kerbs.paint(kit.paints.stone));
}

// Makes a flight of stairs in the frame of one who climbs it towards -Z: from its foot at the origin.
Solid flight(double width, int steps, double rise, double tread) {
    std::vector<glm::dvec2> profile; // (z, height), from the top down
    for (int i = steps - 1; i >= 0; --i) {
        const double y = rise * (i + 1), z = -tread * i;
        profile.insert(profile.end(),
                       {{-tread * (i + 1), y}, {z + 0.027, y}, {z + 0.027, y - 0.031}, {z, y - 0.031}});
    }
    profile.emplace_back(0.0, 0.0);
    const int rows = static_cast<int>(profile.size()) - 1;
    return grid({.columns = 1, .rows = rows}, [&](double s, double t) {
        const glm::dvec2& p = profile[std::lround(t * rows)];
        return glm::dvec3(width * (s - 0.5), p.y, p.x);
    });
}

Solid handrail(const glm::dvec3& from, const glm::dvec3& to) {
    // A profile of (out, up), clockwise seen from its start.
    const std::vector<glm::dvec2> profile = {{-0.11, -0.02}, {-0.115, 0.05}, {-0.09, 0.085}, {0.09, 0.085},
                                             {0.115, 0.05},  {0.11, -0.02},  {-0.11, -0.02}};
    const glm::dvec3 way = to - from;
    const glm::dvec3 side = glm::normalize(glm::cross(way, glm::dvec3(0, 1, 0)));
    const int rows = static_cast<int>(profile.size()) - 1;
    return grid({.columns = 1, .rows = rows}, [&](double s, double t) {
        const glm::dvec2& p = profile[std::lround(t * rows)];
        return from + s * way + side * p.x + glm::dvec3(0, p.y, 0);
    });
}

// Adds a balustrade from one post to another; between posts of different heights its balusters stand on
// stairs.
enum class Posts { Both, First };
void addBalustrade(TownKit& kit, const std::string& name, const glm::dvec3& from, const glm::dvec3& to,
                   Posts posts = Posts::Both) {
    const glm::dvec3 lift(0, 0.16, 0), top(0, 0.92, 0);
    Solid solid = handrail(from + top, to + top);
    solid.add(handrail(from + lift - glm::dvec3(0, 0.08, 0), to + lift - glm::dvec3(0, 0.08, 0)));
    for (const glm::dvec3& at : {from, to}) {
        if (at == to && posts == Posts::First) break;
        solid.add(block(at - glm::dvec3(0.17, 0.4, 0.17), at + glm::dvec3(0.17, 1.09, 0.17)));
        solid.add(block(at + glm::dvec3(-0.21, 1.08, -0.21), at + glm::dvec3(0.21, 1.17, 0.21)));
        solid.add(sphere(0.15, 5).move(at + glm::dvec3(0, 1.29, 0)));
    }
    kit.builder.add(name, solid.paint(kit.paints.stone));
    const double length = glm::distance(glm::dvec2(from.x, from.z), glm::dvec2(to.x, to.z));
    const int count = static_cast<int>(std::lround((length - 0.34) / 0.25));
    for (int i = 0; i < count; ++i) {
        const double t = (0.17 + (length - 0.34) * (i + 0.5) / count) / length;
        kit.builder.place(kit.baluster, {.position = from + t * (to - from) + glm::dvec3(0, 0.155, 0)});
    }
}

void addTerrace(TownKit& kit) {
    const int steps = 12;
    const double rise = kTerrace / steps, tread = 0.3, foot = 22.0, top = foot + tread * steps;
    // The flight climbs to the east.
    Solid stairs = flight(6.0, steps, rise, tread).turnY(-90.0).move({foot, 0.0, 0.0});
    Solid floor = floorOf({top, kArcadeBack, kEastEnd, 6.0, kTerrace});
    floor.add(floorOf({22.0, kArcadeBack, top, -3.0, kPavement}));
    floor.add(floorOf({22.0, 3.0, top, 6.0, kPavement}));
    Solid walls = edgeOf({top, kArcadeBack}, {top, -3.0}, 0.0, kTerrace);
    walls.add(edgeOf({top, 3.0}, {top, 6.0}, 0.0, kTerrace));
    for (double z : {-3.15, 3.15}) {
        const glm::dvec3 low(foot + 0.1, kPavement, z), high(top + 0.17, kTerrace, z);
        // A cheek that climbs with the stairs.
        Solid cheek;
        for (double side : {-0.1, 0.1}) {
            std::vector<glm::dvec3> points = {{low.x, 0.0, z + side},
                                              {high.x, 0.0, z + side},
                                              {high.x, kTerrace + 0.15, z + side},
                                              {low.x, kPavement + 0.15, z + side}};
            if (side < 0.0) std::swap(points[1], points[3]);
            cheek.add(mapped(polygon(points, {side > 0 ? 1.0 : -1.0, 0, 0}, {0, -1, 0})));
        }
        walls.add(cheek);
        addBalustrade(kit, z < 0 ? "Balustrade left" : "Balustrade right", low, high);
    }
    addBalustrade(kit, "Balustrade north", {top + 0.17, kTerrace, kArcadeBack + 0.2},
                  {top + 0.17, kTerrace, -3.15}, Posts::First);
    addBalustrade(kit, "Balustrade south", {top + 0.17, kTerrace, 5.8}, {top + 0.17, kTerrace, 3.15},
                  Posts::First);
    kit.builder.add("Terrace", floor.paint(kit.paints.flags));
    kit.builder.add("Terrace walls", walls.paint(kit.paints.ashlar));
    kit.builder.add("Great stairs", stairs.paint(kit.paints.stone));
}

void addAlleyStairs(TownKit& kit) {
    const int steps = 12;
    const double rise = (kTerrace - kPavement) / steps, tread = 0.3, foot = 9.0;
    // This flight climbs to the south.
    kit.builder.add(
        "Alley stairs",
        flight(2.4, steps, rise, tread).turnY(180.0).move({-9.2, kPavement, foot}).paint(kit.paints.stone));
    kit.builder.add(
        "Upper alley",
        floorOf({-10.4, foot + steps * tread, -8.0, kCourtSouth, kTerrace}).paint(kit.paints.cobbles));
}

} // namespace

void addGround(TownKit& kit) {
    addStreet(kit);
    addTerrace(kit);
    addAlleyStairs(kit);
}

void addArcades(TownKit& kit) {
    struct Row {
        const char* name;
        double x0, x1;
        int bays;
    };
    for (const Row& row : {Row{"Western arcade", kWestEnd, -2.0, 8}, Row{"Eastern arcade", 1.0, 22.0, 7}}) {
        const ArchesDesc desc{
            .from = row.x0, .to = row.x1, .bays = row.bays, .springing = kPavement + 2.5, .top = 4.2};
        const glm::dvec3 front(0, 0, kArcadeFront);
        Solid stone = arches(desc).paint(kit.paints.ashlar);
        stone.add(archBands(desc).paint(kit.paints.stone));
        for (double x : {row.x0 + 0.17, row.x1 - 0.17})
            stone.add(block({x - 0.18, -0.1, -0.51}, {x + 0.18, desc.springing + 0.02, 0.01})
                          .paint(kit.paints.ashlar));
        kit.builder.add(row.name, stone.move(front));
        const double bay = (row.x1 - row.x0) / row.bays;
        for (int i = 1; i < row.bays; ++i)
            kit.builder.place(kit.column, {.position = {row.x0 + bay * i, kPavement, kArcadeFront - 0.25}});
        // The ceiling between the shops and the arches, with a beam at each column.
        Solid ceiling = quad({row.x0, 4.0, kArcadeFront - 0.5}, {row.x1 - row.x0, 0, 0},
                             {0, 0, kArcadeBack - kArcadeFront + 0.5});
        ceiling.paint(kit.paints.planks);
        for (int i = 0; i <= 3 * row.bays; ++i) {
            const double x = row.x0 + 0.17 + (row.x1 - row.x0 - 0.34) * i / (3.0 * row.bays);
            ceiling.add(block({x - 0.07, 3.81, kArcadeBack - 0.05}, {x + 0.07, 4.05, kArcadeFront - 0.45})
                            .paint(kit.paints.timber));
        }
        kit.builder.add(std::string(row.name) + " ceiling", ceiling);
    }
}

} // namespace relume::generate
