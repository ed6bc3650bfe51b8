#pragma once

#include <string>

#include "assets/images/float_image.h"
#include "assets/images/layered_exr.h"
#include "bake/baker/baker.h"

namespace relume {

/// Notes in a lightmap where it comes from: the scene's file name, what was asked for and what was reached,
/// as attributes relume:scene, relume:settings and so on.
void addLightmapAttributes(FloatImage& image, const std::string& scene, const BakeSettings& bake,
                           const LightmapDesc& lightmap, const SolverProgress& progress);

/// Notes the file name of the scene that is written beside a lightmap, which it is of, too: as attribute
/// relume:scene-out. Nothing for "".
void noteSceneOut(FloatImage& image, const std::string& sceneOut);

/// Reads a lightmap that the user made before, of layers their composite. Warns where it was baked for
/// another scene. Throws Error where it does not hold lighting.
FloatImage readLightmap(const std::string& path, const std::string& scene);

/// Warns where the layers of a file were baked for another scene, or are no longer of it.
void warnAboutLayers(const LayeredImage& image, const std::string& path, const std::string& scene);

} // namespace relume
