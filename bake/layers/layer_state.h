#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bake/layers/layer.h"

namespace relume {

/// What the state of a layer goes over.
struct LayerStateSize {
    uint32_t parts = 0; // of tiles
    uint32_t chunks = 0;
};

/// Returns the bytes that the state of a layer takes.
size_t layerStateBytes(const LayerStateSize& size);
/// Appends the part of a layer's state that its buffers do not hold.
void appendLayerState(Layer& layer, const LayerStateSize& size, std::vector<uint8_t>& bytes);
/// Takes it back, from as many bytes.
void takeLayerState(Layer& layer, const LayerStateSize& size, std::span<const uint8_t> bytes);

} // namespace relume
