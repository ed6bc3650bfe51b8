#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bake/gather/link_kit.h"
#include "bake/layers/layer_passes.h"

namespace relume {

/// Makes the picture of all layers: the sum of their weights times their light. It is mixed in the layers'
/// order, so that its bytes are the same whatever was shown before.
class LayerMixer {
public:
    using Layers = std::vector<std::unique_ptr<Layer>>;

    LayerMixer(LinkKit& kit, const LayerPass& pass);

    /// Notes that the layer's light or weight has changed, here and below: that of each of so many layers, or
    /// which layers there are.
    void changed(size_t layer);
    void eachChanged(size_t layers);
    void replaced();

    /// Shows this light in place of so many layers, a result of them all with a vec4 per patch, until
    /// hideSum(). A new one is shown by the same call. `whole` says that it has the light of all that shine.
    void showSum(const vk::Buffer& sum, size_t layers, bool whole);
    void hideSum(size_t layers);
    bool showsSum() const { return sum_ != nullptr; }

    /// Shows the weighted sum of these former layers in place of those that are covered, until endStandIn().
    /// It is made in the buffer, a vec4 per patch.
    void beginStandIn(const std::vector<const Layer*>& former, vk::Buffer to);
    /// Shows this light likewise, which is of another bake; so does composite() at once.
    void beginStandIn(const std::vector<glm::vec4>& light, vk::Buffer to);
    bool hasStandIn() const { return static_cast<bool>(standIn_); }
    void endStandIn(size_t layers);

    /// Makes `direct` the weighted sum of the direct light of all layers that shine and have any.
    void mixDirect(const Layers& layers, const vk::Buffer& direct);
    /// Mixes what a viewer is shown, where it has changed; tells whether it has. As long as no light has its
    /// bounces, that is the direct light that there is.
    bool mixForViewer(const Layers& layers);
    /// Tells whether all that shines is shown with its bounces, in some state.
    bool isComplete(const Layers& layers) const;
    /// Tells whether there is anything to show: without light all would be black.
    bool showsAny(const Layers& layers) const;
    /// Tells whether any light is shown with bounces.
    bool showsBounces(const Layers& layers) const;
    /// Returns the composite, vec4 per patch: on the device as it was mixed last, and as it is now.
    const vk::Buffer& composite() const { return composite_; }
    const std::vector<glm::vec4>& light(const Layers& layers);
    const vk::Buffer& mixed(const Layers& layers); // as it is now, on the device
    uint64_t version() const { return version_; }  // of what a viewer is shown

private:
    using Weights = std::vector<shader::LayerWeight>;
    Weights shares(const Layers& layers, std::optional<size_t> without, std::optional<size_t> only) const;
    uint32_t writeWeights(const Weights& list);
    void run(const Weights& list, const vk::Buffer* base, const vk::Buffer& to);
    bool mixFirstLight(const Layers& layers);
    void mix(const Layers& layers);
    void mixOne(const Layers& layers, size_t layer);

    LinkKit& kit_;
    const LayerPass& pass_;
    vk::Buffer weights_;   // LayerWeight[]
    vk::Buffer composite_; // vec4 per patch
    vk::Buffer rest_;      // the composite without restOf_
    std::optional<size_t> restOf_;
    vk::Buffer standIn_; // vec4 per patch: light of those that were grouped otherwise before
    const vk::Buffer* sum_ = nullptr;
    bool sumWhole_ = false;       // sum_ has the light of all that shine
    std::vector<size_t> changed_; // layers since the composite was made
    bool allChanged_ = false;     // all of them, and which ones there are
    size_t lit_ = 0;              // layers with direct light, while that is shown
    bool stale_ = true;           // light_ is behind
    std::vector<glm::vec4> light_;
    uint64_t version_ = 0;
};

} // namespace relume
