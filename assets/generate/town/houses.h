#pragma once

#include <string>
#include <vector>

#include "assets/generate/town/kit.h"

namespace relume::generate {

/// Is a row of fittings on one side of a house.
struct FittingRow {
    Fitting fitting = Fitting::Tall;
    double bottom = 0.0;      // [m] of the openings
    std::vector<double> xs{}; // [m] middles of the openings along the wall
    bool hasShutters = false, hasFlowers = false;
};

/// Is one side of a house. Sides are numbered as Frame::quarter: south, east, north, west.
struct HouseSide {
    std::vector<FittingRow> rows{};
    std::vector<Opening> holes{}; // archways and the like, which the caller lines
    double from = -0.2;           // [m] where the wall begins; above the eaves: there is no wall
    bool hasTiles = false;        // of an eaves side: its slope has tiles of its own instead of a picture
    bool hasCornice = false;
};

/// Is a house with a gable roof. It stands on the ground and is closed but for what `from` leaves out.
struct House {
    std::string name;
    glm::dvec2 low{0.0}, high{0.0}; // [m] (x, z)
    double eaves = 8.0;             // [m]
    bool ridgeAlongX = true;
    int wall = 0, trim = 0, shutter = 0; // materials; the kit's shutter
    HouseSide sides[4];
    std::vector<double> courses{};      // [m] string courses on sides that have a cornice
    std::vector<glm::dvec2> chimneys{}; // along the ridge and across it, from the middle [m]
};

constexpr double kNoWall = 1e3; // [m] HouseSide::from of a side that a neighbour hides

/// Returns so many places spread evenly over [0, width].
std::vector<double> evenly(double width, int count);

/// Returns the frame of a side of a house, and how wide that is.
Frame sideOf(const House& house, int side);
double widthOf(const House& house, int side);

/// Adds the house with its windows, roof and chimneys.
void addHouse(TownKit& kit, const House& house);

} // namespace relume::generate
