#pragma once

#include <string>

#include "assets/images/float_image.h"
#include "bake/baker/baker.h"

namespace relume {

/// Notes in a lightmap where it comes from: the scene's file name, what was asked for and what was reached,
/// as attributes relume:scene, relume:settings and so on.
void addLightmapAttributes(FloatImage& image, const std::string& scene, const BakeSettings& bake,
                           const LightmapDesc& lightmap, const SolverProgress& progress);

} // namespace relume
