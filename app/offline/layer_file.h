#pragma once

#include <map>
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
/// filled as in the composite, which is the sum of the others and bears these attributes. desc.quantity must
/// be lighting.
LayeredImage layeredImage(const Baker& baker, const Scene& scene, const LightmapDesc& desc,
                          const std::map<std::string, std::string>& attributes);

/// Writes the image by writeLayeredExr, and a line to the log about each layer.
void writeLayers(const std::string& path, const LayeredImage& image, ExrType type,
                 ExrCompression compression);

/// Returns the reason of each layer that does not show the scene as it is, one line each.
std::vector<std::string> staleReasons(const LayerSolver& solver);
/// Returns the reasons of all layers in one line; "": all of them show the scene as it is.
std::string staleLayers(const LayerSolver& solver);

} // namespace relume
