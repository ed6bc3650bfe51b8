#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "bake/layers/layer.h"
#include "bake/layers/wanted_layers.h"

namespace relume {

/// The ledger counts the light of layers as that of this owner (vk::MemoryOwner).
constexpr const char* kLayerLightOwner = "light of layers";

/// Keeps the layers that are shown, former ones for an undo as long as there is memory, and of those beyond
/// it what makes their bytes again.
class LayerStore {
public:
    /// Takes at most so many bytes for all layers, and so many of them on the device: those beyond are in the
    /// host's memory. Each light buffer of a layer has `lightBytes`.
    LayerStore(const vk::Device& device, VkDeviceSize lightBytes, uint64_t bytes, uint64_t deviceBytes)
        : device_(device), lightBytes_(lightBytes), bytes_(bytes), deviceBytes_(deviceBytes) {}

    /// Returns the layers in the order in which they were wanted.
    const std::vector<std::unique_ptr<Layer>>& layers() const { return layers_; }
    bool holds(const Layer* layer) const;
    uint64_t bytes() const { return bytes_; } // at most, of all of them

    /// Takes what fits of the layers that are or were there, nullptr for each that is wanted anew. A group of
    /// which nothing shines stays as it is, for it may shine again.
    std::vector<std::unique_ptr<Layer>> take(const std::vector<WantedLayer>& wanted);
    /// Makes those that are wanted anew and keeps them all in place of the layers before, which are archived.
    /// A new layer shows the former one of its light until it has a level; inherit(from, to) hears of the
    /// two.
    void replace(const std::vector<WantedLayer>& wanted, std::vector<std::unique_ptr<Layer>> taken,
                 const std::vector<bool>& covered, const std::function<void(const Layer&, Layer&)>& inherit);
    /// Keeps a layer for an undo, as long as there is memory for it.
    void archive(std::unique_ptr<Layer> layer);

    /// Gives away the layers that are shown; all that is kept beside them goes.
    std::vector<std::unique_ptr<Layer>> release();

    /// Returns a buffer of a vec4 per patch, a spare one where there is one.
    vk::Buffer takeBuffer(const char* name);

private:
    /// The record of a layer that memory was short for.
    struct Record {
        LightCacheKey cacheKey;
        LayerLevel level;
        std::vector<uint32_t> directSteps;
    };
    std::unique_ptr<Layer> takeOne(const WantedLayer& wanted);
    void recycle(Layer& layer);
    void remember(const Layer& layer);
    void recall(Layer& layer) const;

    const vk::Device& device_;
    VkDeviceSize lightBytes_;
    uint64_t bytes_, deviceBytes_;
    std::vector<std::unique_ptr<Layer>> layers_;
    std::vector<std::unique_ptr<Layer>> former_; // kept for an undo, the newest last
    std::vector<Record> records_;                // of those that are no longer kept, the newest last
    std::vector<vk::Buffer> spare_;              // of layers that are gone, to be used again
};

} // namespace relume
