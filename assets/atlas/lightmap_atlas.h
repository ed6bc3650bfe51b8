#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "assets/model/scene.h"

namespace relume {

/// Tells where one instance's lightmap UVs go: atlas uv = uv * scale + offset.
struct AtlasRect {
    glm::vec2 scale{1.0f};
    glm::vec2 offset{0.0f};
    int texCoord =
        -1; // the set taken, 0 or 1 (of every primitive that has it); -1: this instance has no usable UVs
};

/// Holds one atlas for the whole scene.
struct LightmapAtlas {
    std::vector<AtlasRect> instances; // one per Scene::instances
    bool repacked = false;            // every instance got a rectangle of its own
    std::vector<std::string> warnings;
    uint64_t visits = 0; // of grid cells, which is what finding overlaps has cost
};

/// Chooses the lightmap UVs: TEXCOORD_1, else TEXCOORD_0 where it is a valid atlas (inside [0,1], overlap
/// below 1 % of the UV area). If all instances together form one valid atlas, it is used as it is; otherwise
/// each valid instance gets its own rectangle by world area with 2 texels of gutter at `size` [texels]. An
/// instance without usable UVs blocks light and is warned about. Throws Error where no instance has usable
/// UVs. Messages advise an unwrap, unless the scene is `unwrapped` already.
LightmapAtlas buildAtlas(const Scene& scene, uint32_t size, bool unwrapped = false);

/// Returns the scene with the atlas in TEXCOORD_1; instances that were moved in it get a mesh of their own.
Scene withAtlas(const Scene& scene, const LightmapAtlas& atlas);

/// Returns the UV set that all of a mesh's primitives have and that is a valid atlas by itself: 1, else 0,
/// else -1.
int lightmapSet(const Mesh& mesh);

/// Returns how many meshes that instances use have a surface and no such set.
size_t countUnmapped(const Scene& scene);

/// Tells how well a scene's lightmap UVs use the atlas.
struct AtlasStatistics {
    double coverage = 0; // covered share of the unit square [1]
    double overlap = 0;  // share of the covered area covered more than once [1]
    double texelDensityMin = 0, texelDensityMean = 0,
           texelDensityMax = 0; // [texels/m] at `size`, per triangle
};
AtlasStatistics measureAtlas(const Scene& scene, const LightmapAtlas& atlas, uint32_t size);

} // namespace relume
