#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/layers/layer.h"

namespace relume {

/// Returns the bytes that the state of a layer takes, with so many parts of tiles.
size_t layerStateBytes(uint32_t parts);
/// Appends the part of a layer's state that its buffers do not hold.
void appendLayerState(Layer& layer, uint32_t parts, std::vector<uint8_t>& bytes);
/// Takes it back, from as many bytes.
void takeLayerState(Layer& layer, std::span<const uint8_t> bytes);

} // namespace relume
