#pragma once

#include "assets/generate/town/paints.h"
#include "assets/generate/town/walls.h"

// This is what facades are made of again and again: each thing is one mesh with many instances.
namespace relume::generate {

/// Are windows and doors that fill an opening of a wall. All but the glazed ones end in dark panes or leaves,
/// behind which there is nothing.
enum class Fitting { Tall, Small, Shop, Door, GlazedTall, GlazedShop, Count };

/// Returns the size of the opening that a fitting fills [m].
glm::dvec2 sizeOf(Fitting fitting);
/// Returns how deep its opening is [m]: the thickness of the wall where it is glazed.
double depthOf(Fitting fitting);
constexpr double kWall = 0.35; // [m] thickness of walls in front of rooms

struct TownKit {
    SceneBuilder& builder;
    TownPaints paints;
    int fitting[static_cast<int>(Fitting::Count)] = {};
    int shutter[2] = {}; // green, blue
    int baluster = 0, rafter = 0, tileRow = 0, column = 0, flowerBox = 0;
    int barrel = 0, crate = 0, bench = 0, planter = 0, lantern = 0, bracketLamp = 0;
    int fruit[kFruits] = {};
    int tree = 0;
    int picture = 0; // material
};

/// Makes the meshes of the kit's first two lines; props.h makes the rest.
void makeFittings(TownKit& kit);

constexpr double kTilePitch = 30.0;       // [degrees] of every roof
constexpr glm::dvec2 kTileRow(2.0, 1.05); // [m] along and up the slope, of one TownKit::tileRow

/// Places a fitting at the lower left corner `at` of its opening [m].
void fit(TownKit& kit, Fitting fitting, const Frame& frame, const glm::dvec2& at);
/// Adds a pair of open shutters to it.
void addShutters(TownKit& kit, Fitting fitting, const Frame& frame, const glm::dvec2& at, int color);

} // namespace relume::generate
