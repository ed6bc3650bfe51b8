#pragma once

#include "assets/model/scene.h"

namespace relume {

/// Returns the metallic factor of which an engine makes our albedo: ours is base x (1 - m + m r^2 / 2), as a
/// rough metal sends some light on (shaders/lib/scene_material.glsl); that of engines is base x (1 - m).
inline float engineMetallic(float metallic, float roughness) {
    return metallic * (1.0f - 0.5f * roughness * roughness);
}

/// Gives all materials of a scene such metallic factors. A metallic-roughness texture is replaced by one
/// whose blue channel has them; uses with equal factors share it.
void giveEngineMetals(Scene& scene);

} // namespace relume
