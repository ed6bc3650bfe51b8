#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/world_mesh.h"
#include "assets/images/float_image.h"
#include "assets/model/scene.h"
#include "bake/vk/device.h"

namespace relume {

/// A level with the atlas that its lightmap is in. What it names must outlive it.
struct AtlasLevel {
    const Scene& scene;
    const LightmapAtlas& atlas;
    const WorldMesh& mesh; // of the scene, flattened by the atlas
};

/// What leaves a level's surfaces, in the lightmap's layout: [size * size] texels, row 0 = v 0.
struct SurfaceLight {
    uint32_t size = 0;                // edge [texels]
    uint32_t rings = 0;               // around charts that belong to them
    std::vector<glm::vec3> reflected; // lighting times albedo [cd/m^2]
    std::vector<glm::vec3> emitted;   // [cd/m^2]
    std::vector<uint32_t> material;   // 1 + index into the scene's materials; 0: no surface
};

/// Draws the surfaces into textures of an edge of `size` texels and multiplies them with the lightmap, which
/// may be smaller and is then filtered linearly. Throws Error.
SurfaceLight surfaceLight(const vk::Device& device, const AtlasLevel& level, const FloatImage& lightmap,
                          uint32_t size);

/// Gives texels without a surface the mean of what is near, so that no filter meets a black one: `rings` of
/// them around charts that of their neighbours, as a bake does, the rest that of larger and larger squares.
/// `has` says which texels have a value, [size * size] as `texels`.
void fillBetween(std::vector<glm::vec3>& texels, std::vector<bool> has, uint32_t size, uint32_t rings);

/// Returns the exposure [EV] that a picture of all surfaces asks for, texel by texel.
float exposureOf(const SurfaceLight& light);

} // namespace relume
