#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bake/layers/layer.h"
#include "bake/layers/scene_states.h"
#include "bake/surface/patch_set.h"

namespace relume {

/// A layer as the scene is to have it now.
struct WantedLayer {
    LightCacheKey cacheKey;
    LightSource source; // weight: with its switches, here and of members
    std::vector<LightSource> members;

    /// Tells whether it is a group of which nothing shines: nothing is known of its members' weights then.
    bool isDarkGroup() const { return !members.empty() && cacheKey.members.empty(); }
};

/// Returns the layers of a scene in this state, as the switches have it: no more than there is room for, in
/// the order of groupLights(). With names of lights (LayerSettings::lights), only those of these lights.
std::vector<WantedLayer> wantedLayers(const Scene& scene, const LightMix& mix, uint64_t room,
                                      const SceneState& state, std::span<const std::string> lights = {});

/// Tells whether the layer's light is to come from other layers, where nobody wants it as it is.
bool isRegrouped(const Layer& layer, const std::vector<WantedLayer>& wanted);

/// The layers that a picture of the former ones stands in for, where lights go into a group that had layers
/// or come out of one: their shares cannot be told apart, nor may they grow dark.
struct StandInPlan {
    std::vector<bool> covered;     // one per wanted layer; all false where nothing is regrouped
    std::vector<const Layer*> sum; // former layers whose sum is the picture
    bool regroups = false;
};
/// Plans that. `left` are the layers that nobody took, `taken` those that were, nullptr for new ones.
StandInPlan planStandIn(const std::vector<WantedLayer>& wanted,
                        const std::vector<std::unique_ptr<Layer>>& taken,
                        const std::vector<std::unique_ptr<Layer>>& left);

/// Returns for how many layers there is room in so many bytes: each has direct light and a result.
uint64_t layerRoom(const PatchSet& patches, uint64_t bytes);
/// Tells in one line why so many bytes are not enough for layers of the scene's lights, not even for groups
/// of them, and what helps; returns "" where they are enough. Lights that are named are never grouped: who
/// shares a layer with whom would depend on who else is named.
std::string layerProblem(const Scene& scene, const PatchSet& patches, uint64_t bytes,
                         std::span<const std::string> lights = {});

} // namespace relume
