#pragma once

#include "assets/layered_exr.h"
#include "bake/baker.h"
#include "bake/layer_solver.h"

namespace relume {

/// The lightmap of a layered bake as it stands, light by light: each layer with its weight, light and level,
/// and with what it does not show of the scene any more. Seams are filled as in the composite, which is the
/// sum of the others. desc.quantity: lighting.
LayeredImage layeredImage(const Baker& baker, LayerSolver& solver, const Scene& scene,
                          const LightmapDesc& desc);

/// Of all layers, one line; "": all of them show the scene as it is.
std::string staleLayers(const LayerSolver& solver);

} // namespace relume
