#pragma once

#include "assets/generate/town/kit.h"

namespace relume::generate {

/// Is a room behind a wall. Places are in the wall's frame.
struct InnerRoom {
    std::string name;
    Frame frame;
    double from = 0.0, to = 0.0, depth = 5.0; // [m] along the wall; from its inner face to the back
    double floor = 0.0, ceiling = 3.0;        // [m]
    std::vector<Opening> openings{};          // of the wall
    int wall = 0;                             // material
};

/// Adds floor, ceiling and four walls, seen from inside.
void addShell(TownKit& kit, const InnerRoom& room);

/// Add what stands in the shop, the tavern and the study.
void furnishShop(TownKit& kit, const InnerRoom& room);
void furnishTavern(TownKit& kit, const InnerRoom& room);
void furnishStudy(TownKit& kit, const InnerRoom& room);

} // namespace relume::generate
