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
        Lamp,    // of Scene::lights
        Sky,
        Group, // several that share a layer (bake/layers/light_groups.h)
    };
    Kind kind = Kind::Sky;
    uint32_t index = 0;    // Emitter: into Scene::instances; Lamp: into Scene::lights; Group: which one
    uint32_t material = 0; // Emitter: into Scene::materials

    auto operator<=>(const LightKey&) const = default;
};

/// A light as users see it: what has a layer of its own.
struct LightSource {
    LightKey key;
    std::string name;       // unlike any other light's
    glm::vec3 weight{0.0f}; // of its pattern: emission [cd/m^2], colour times intensity [cd, lux, cd/m^2]
};

/// All lights of a scene, emitters first, then lamps, then the sky. Emitters and a sky without emission are
/// none, nor are hidden instances; lamps of no intensity are lights all the same.
std::vector<LightSource> lightSources(const Scene& scene);

/// Switches of a mix board: they weigh lights and change nothing else.
struct LightMix {
    std::vector<LightKey> muted, solo; // solo: where there is any, only these shine

    bool shines(const LightKey& key) const;
    /// To go with Scene::lights where the lamp of this index is gone, or was put in before those behind.
    void lampErased(uint32_t index);
    void lampInserted(uint32_t index);
    bool operator==(const LightMix&) const = default;
};

} // namespace relume
