#pragma once

#include "assets/generate/town/kit.h"

namespace relume::generate {

// Heights and places that ground, houses and props agree on [m].
constexpr double kPavement = 0.12, kTerrace = 1.8;
constexpr double kStreetHalf = 3.0;   // half the width of the carriageway
constexpr double kSouthFront = 4.2;   // z of the southern houses' fronts
constexpr double kArcadeFront = -4.2; // z of the northern houses' fronts
constexpr double kArcadeBack = -7.6;  // z of the shops behind the arcade
constexpr double kWestEnd = -26.0, kEastEnd = 33.0;
constexpr double kCourtSouth = 25.0, kCourtNorth = 14.0, kCourtWest = 2.0, kCourtEast = 16.0;

/// Adds street, pavements, squares, stairs with balustrades and the terrace.
void addGround(TownKit& kit);

/// Adds the arcade on the street's northern side, with its columns and ceiling.
void addArcades(TownKit& kit);

} // namespace relume::generate
