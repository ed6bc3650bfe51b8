#pragma once

#include <string>
#include <vector>

#include "assets/images/layered_exr.h"
#include "bake/baker/baker.h"
#include "bake/layers/layer_solver.h"

namespace relume {

/// Returns a layer's name, weight, light and level, and what it does not show of the scene any more: all but
/// its image.
LayeredImage::Layer layerWithoutImage(const Scene& scene, const Layer& layer);

/// Returns the lightmap of a bake that has layers (Baker::layers) as it stands, light by light: each
/// layer with its weight, light and level, and with what it does not show of the scene any more. Seams are
/// filled as in the composite, which is Baker::lightmap: once the bake is done the sum of weight times layer.
/// desc.quantity must be lighting.
LayeredImage layeredImage(const Baker& baker, const Scene& scene, const LightmapDesc& desc);

/// Rounds the layers to what a file of this type at `path` holds, and makes the composite their sum again. So
/// files of the same layers have the same bytes, however many processes baked them.
void fitTo(const std::string& path, LayeredImage& image, ExrType type);

/// Writes the image by writeLayeredLightmap, and a line to the log about each layer.
void writeLayers(const std::string& path, const LayeredImage& image, ExrType type,
                 ExrCompression compression);

/// Returns the reason of each layer that does not show the scene as it is, one line each.
std::vector<std::string> staleReasons(const LayerSolver& solver);
/// Returns the reasons of all layers in one line; "": all of them show the scene as it is.
std::string staleLayers(const LayerSolver& solver);

} // namespace relume
