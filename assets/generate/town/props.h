#pragma once

#include <string>

#include "assets/generate/town/kit.h"

namespace relume::generate {

/// Makes the meshes of what stands about: barrels, crates, benches, planters, lanterns, fruit, trees.
void makeProps(TownKit& kit);

/// Adds a market stall, its counter towards +Z before it is turned [degrees].
void addStall(TownKit& kit, const std::string& name, const glm::dvec3& at, double turn, int cloth);

/// Adds the market's well and the courtyard's fountain.
void addWell(TownKit& kit, const glm::dvec3& at);
void addFountain(TownKit& kit, const glm::dvec3& at);

/// Adds a canvas awning over a shop window whose opening begins at `x` along the frame's wall.
void addAwning(TownKit& kit, const std::string& name, const Frame& frame, double x, double width,
               double height);

/// Adds a balcony with an iron railing under the window whose sill is at `height`.
void addBalcony(TownKit& kit, const std::string& name, const Frame& frame, double x, double height);

/// Adds a line of laundry from wall to wall.
void addLaundry(TownKit& kit, const glm::dvec3& from, const glm::dvec3& to);

/// Adds sheets of ivy on a wall, from x = `from` to `to`.
void addIvy(TownKit& kit, const std::string& name, const Frame& frame, double from, double to, double height);

/// Makes a sheet of cloth, two sides, that hangs from a horizontal edge of `width` along X.
Solid hangingCloth(double width, double drop, double wave);

} // namespace relume::generate
