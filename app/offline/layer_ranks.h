#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "assets/images/layered_exr.h"
#include "bake/ranks/ranks.h"

namespace relume {

/// Returns those of these lights whose layers a rank bakes: they are dealt in turn, and none is left for the
/// last ranks where there are more of these.
std::vector<std::string> dealtLights(const std::vector<std::string>& lights, uint32_t rank, uint32_t ranks);

/// Return a layered image as bytes, all of its bits, and one of such bytes.
std::vector<std::byte> packedLayers(const LayeredImage& image);
LayeredImage unpackedLayers(std::span<const std::byte> bytes);

/// Brings the layers that all ranks have baked, each of lights of its own, to the first one, and puts them
/// together there as joinLayers() does, with their sum as the composite. Returns an image without layers on
/// the others. All ranks that have `dealt` lights give an image of these; the others an empty one.
LayeredImage gatherLayers(Ranks& ranks, LayeredImage own);

} // namespace relume
