#pragma once

#include "assets/model/scene.h"

// These pictures are painted by arithmetic and the same to the last bit everywhere. Tiles repeat without a
// seam.
namespace relume::generate {

Image floorTiles();    // four by four octagons with dark squares between
Image woodPanelling(); // one raised panel with grain
Image wallpaper();     // stripes with small lozenges

/// painting() returns a painting to hang on a wall, width : height = 4 : 3 or 3 : 4 (isUpright). `kind` goes
/// from 0 to kPaintings - 1.
constexpr int kPaintings = 7;
Image painting(int kind);
bool isUpright(int kind);

} // namespace relume::generate
