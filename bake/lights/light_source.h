#pragma once

#include <compare>
#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Tells the lights of a scene apart.
struct LightKey {
    enum class Kind : uint8_t {
        Emitter, // a mesh instance with a material that emits
        Lamp,    // an analytic light of Scene::lights
        Sky,
        Group, // several that share a layer (bake/layers/light_groups.h)
    };
    Kind kind = Kind::Sky;
    uint32_t index = 0;    // Emitter: into Scene::instances; Lamp: into Scene::lights; Group: which one
    uint32_t material = 0; // Emitter: into Scene::materials

    auto operator<=>(const LightKey&) const = default;
};

/// A light as users see it: it has a layer of its own.
struct LightSource {
    LightKey key;
    std::string name;       // unlike any other light's
    glm::vec3 weight{0.0f}; // emission [cd/m^2] or colour times intensity [cd, lux, cd/m^2]
};

/// Returns all lights of a scene: mesh lights first, then analytic lights, then the sky. Without emission
/// mesh lights and the sky are none, nor are hidden instances; analytic lights of no intensity are lights all
/// the same.
std::vector<LightSource> lightSources(const Scene& scene);

/// The switches of a mix board: they weigh lights and change nothing else.
struct LightMix {
    std::vector<LightKey> muted, solo; // solo: where there is any, only these shine

    bool shines(const LightKey& key) const;
    /// Follow Scene::lights, where the light of this index is gone, or was put in before those behind.
    void lampErased(uint32_t index);
    void lampInserted(uint32_t index);
    bool operator==(const LightMix&) const = default;
};

} // namespace relume
