#include "bake/layers/layer_state.h"

#include <algorithm>
#include <cstring>

namespace relume {
namespace {

struct LayerState {
    uint32_t directSamplePasses = 0;
    LayerLevel level;
    SmoothingWidth width;
    double light = 0, count = 0, directVariance = 0, indirectVariance = 0, iterationError = 1, error = 1;
    LayerPlan plan;
    bool biasKnown = false;
};

constexpr size_t kSketchBytes = kSketchEntries * sizeof(glm::vec3);

} // namespace

size_t layerStateBytes(const LayerStateSize& size) {
    return sizeof(LayerState) + kSketchBytes + size.chunks * sizeof(float) + size.parts;
}

void appendLayerState(Layer& layer, const LayerStateSize& size, std::vector<uint8_t>& bytes) {
    LayerState own;
    std::memset(static_cast<void*>(&own), 0, sizeof own); // padding, too
    own.directSamplePasses = layer.directSamplePasses;
    own.level = layer.level;
    own.width = layer.width;
    own.light = layer.light;
    own.count = layer.count;
    own.directVariance = layer.directVariance;
    own.indirectVariance = layer.indirectVariance;
    own.iterationError = layer.iterationError;
    own.error = layer.error;
    own.plan.wanted = layer.plan.wanted; // by name, as the whole would bring its padding along
    own.plan.converged = layer.plan.converged;
    own.plan.hasty = layer.plan.hasty;
    own.plan.directFall = layer.plan.directFall;
    own.biasKnown = !layer.sketch.bias.empty();
    const auto* from = reinterpret_cast<const uint8_t*>(&own);
    bytes.insert(bytes.end(), from, from + sizeof own);
    std::vector<glm::vec3> entries = layer.sketch.entries;
    entries.resize(kSketchEntries, glm::vec3(0.0f)); // which is as good as none
    const auto* sketch = reinterpret_cast<const uint8_t*>(entries.data());
    bytes.insert(bytes.end(), sketch, sketch + kSketchBytes);
    std::vector<float> bias = layer.sketch.bias;
    bias.resize(size.chunks, 0.0f);
    const auto* biases = reinterpret_cast<const uint8_t*>(bias.data());
    bytes.insert(bytes.end(), biases, biases + bias.size() * sizeof(float));
    layer.penumbra.resize(size.parts, 0);
    bytes.insert(bytes.end(), layer.penumbra.begin(), layer.penumbra.end());
}

void takeLayerState(Layer& layer, const LayerStateSize& size, std::span<const uint8_t> bytes) {
    LayerState from;
    std::memcpy(&from, bytes.data(), sizeof from);
    const std::span<const uint8_t> sketch = bytes.subspan(sizeof from, kSketchBytes);
    const size_t biasBytes = size.chunks * sizeof(float);
    const std::span<const uint8_t> bias = bytes.subspan(sizeof from + kSketchBytes, biasBytes);
    const std::span<const uint8_t> penumbra = bytes.subspan(sizeof from + kSketchBytes + biasBytes);
    layer.sketch.entries.resize(kSketchEntries);
    std::memcpy(layer.sketch.entries.data(), sketch.data(), kSketchBytes);
    layer.sketch.bias.resize(from.biasKnown ? size.chunks : 0);
    if (from.biasKnown) std::memcpy(layer.sketch.bias.data(), bias.data(), biasBytes);
    layer.sketch.number = newSketchNumber();
    layer.penumbra.assign(penumbra.begin(), penumbra.end());
    layer.directSamplePasses = from.directSamplePasses;
    layer.directSteps.clear();
    for (uint32_t made = 0; made < from.directSamplePasses; layer.directSteps.push_back(made))
        made = std::min(nextDirectStep(made), from.directSamplePasses);
    layer.level = from.level;
    layer.width = from.width;
    layer.light = from.light;
    layer.count = from.count;
    layer.directVariance = from.directVariance;
    layer.indirectVariance = from.indirectVariance;
    layer.iterationError = from.iterationError;
    layer.error = from.error;
    layer.plan = from.plan;
}

} // namespace relume
