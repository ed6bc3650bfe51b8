#pragma once

#include "assets/model/scene.h"

// A small old town in the late afternoon, about 60 by 50 metres. North is -Z, the street runs along X.
namespace relume::generate {

/// Makes the town: sun, sky and twenty lamps, several hundred instances, no lightmap UVs.
Scene town();

/// Makes a corner of its street as levels come from elsewhere: a mesh for each material, doubled faces,
/// triangles without area; no lights, cameras or lightmap UVs.
Scene rawCorner();

} // namespace relume::generate
