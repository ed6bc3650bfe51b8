#pragma once

#include "assets/model/scene.h"

// There is one function per generated scene, in assets/generate/scene_<name>.cpp.
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
