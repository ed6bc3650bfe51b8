#pragma once

#include "assets/generate/town/kit.h"

namespace relume::generate {

/// Add the houses on either side of the street, and those around the court, with the shops behind the arcade
/// and the three rooms.
void addNorthernRow(TownKit& kit);
void addSouthernRow(TownKit& kit);
void addCourtHouses(TownKit& kit);

} // namespace relume::generate
