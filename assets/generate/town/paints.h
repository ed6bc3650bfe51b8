#pragma once

#include <array>

#include "assets/generate/shapes/scene_builder.h"

namespace relume::generate {

constexpr int kPlasters = 5, kFruits = 4, kCloths = 3;

/// Holds what walls, roofs and the ground are made of.
struct MasonryPaints {
    std::array<int, kPlasters> plaster{}; // of houses
    int ashlar = 0, stone = 0, brick = 0; // walls of cut stone; trim; chimneys and garden walls
    int cobbles = 0, flags = 0, tiles = 0, tileRows = 0, terracotta = 0, soil = 0;
};

/// Holds what is built into them.
struct JoineryPaints {
    int boards = 0, timber = 0, planks = 0, green = 0, blue = 0, white = 0, brown = 0;
    int darkGlass = 0, glass = 0, iron = 0, brass = 0, water = 0;
    int glow = 0; // of bulbs
};

/// Holds what stands about and hangs.
struct GoodsPaints {
    int leaves = 0, ivy = 0, flowers = 0, grille = 0; // alpha mask
    int stripes = 0, rug = 0, books = 0, inside = 0, wallpaper = 0;
    std::array<int, kFruits> fruit{};
    std::array<int, kCloths> cloth{};
};

/// Holds the town's materials, by number. Colours are linear, so a plaster of 0.6 reflects 60 % of the light.
struct TownPaints : MasonryPaints, JoineryPaints, GoodsPaints {};

TownPaints makeTownPaints(SceneBuilder& builder);

} // namespace relume::generate
