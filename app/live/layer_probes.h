#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "app/live/bake_desk.h"
#include "bake/layers/layer_solver.h"

namespace relume {

/// Reads what the layers of lights hold at some texels, and reads a layer again when it has changed. That is
/// as much as a small picture needs, never a whole layer. Only the bake thread uses it.
class LayerProbes {
public:
    explicit LayerProbes(const vk::Device& device) : device_(device), commands_(device) {}

    /// Replaces what was asked for before.
    void ask(ProbeRequest request);
    /// Forgets what was told, because the patches are others now: all layers are told again.
    void forget();

    using PatchAt = std::function<uint32_t(uint32_t texel)>; // shader::kNoPatch: beside all charts
    /// Returns the next layer that was not told as it is now, or nothing when nothing is asked for or all
    /// were told.
    std::optional<LayerProbe> next(const LayerSolver& solver, const PatchAt& patchAt);

private:
    /// The cache key and level, which decide a layer's bytes.
    struct Told {
        LightCacheKey cacheKey;
        LayerLevel level;

        bool operator==(const Told&) const = default;
    };
    std::vector<glm::vec3> read(const vk::Buffer& result);

    const vk::Device& device_;
    vk::Commands commands_;
    ProbeRequest request_;
    std::vector<uint32_t> patches_; // of the texels; empty: not looked up yet
    vk::Buffer values_;             // vec4 per texel
    std::map<LightKey, Told> told_;
};

} // namespace relume
