#pragma once

#include "assets/scene.h"

// One function per generated scene, in assets/scene_<name>.cpp.
namespace relume::generate {

Scene cornellSmall();
Scene cornellGeom();
Scene cornellLayers();
Scene cornellStatue();
Scene gallery();
Scene octagon();
Scene atrium();
Scene lamps();

} // namespace relume::generate
