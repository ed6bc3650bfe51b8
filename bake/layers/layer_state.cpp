#include "bake/layers/layer_state.h"

#include <cstring>

namespace relume {
namespace {

struct LayerState {
    uint32_t directRounds = 0;
    LayerLevel level;
    SmoothingWidth width;
    double light = 0, count = 0, directVariance = 0, indirectVariance = 0, iterationError = 1, error = 1;
    bool converged = false;
};

} // namespace

size_t layerStateBytes(uint32_t parts) {
    return sizeof(LayerState) + parts;
}

void appendLayerState(Layer& layer, uint32_t parts, std::vector<uint8_t>& bytes) {
    LayerState own;
    std::memset(static_cast<void*>(&own), 0, sizeof own); // padding, too
    own.directRounds = layer.directRounds;
    own.level = layer.level;
    own.width = layer.width;
    own.light = layer.light;
    own.count = layer.count;
    own.directVariance = layer.directVariance;
    own.indirectVariance = layer.indirectVariance;
    own.iterationError = layer.iterationError;
    own.error = layer.error;
    own.converged = layer.converged;
    const auto* from = reinterpret_cast<const uint8_t*>(&own);
    bytes.insert(bytes.end(), from, from + sizeof own);
    layer.penumbra.resize(parts, 0);
    bytes.insert(bytes.end(), layer.penumbra.begin(), layer.penumbra.end());
}

void takeLayerState(Layer& layer, std::span<const uint8_t> bytes) {
    LayerState from;
    std::memcpy(&from, bytes.data(), sizeof from);
    layer.penumbra.assign(bytes.begin() + sizeof from, bytes.end());
    layer.directRounds = from.directRounds;
    layer.directSteps.assign(1, from.directRounds);
    layer.level = from.level;
    layer.width = from.width;
    layer.light = from.light;
    layer.count = from.count;
    layer.directVariance = from.directVariance;
    layer.indirectVariance = from.indirectVariance;
    layer.iterationError = from.iterationError;
    layer.error = from.error;
    layer.converged = from.converged;
}

} // namespace relume
