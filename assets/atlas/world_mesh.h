#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "assets/atlas/lightmap_atlas.h"
#include "assets/model/scene.h"

namespace relume {

constexpr uint32_t kNoChart = 0xffffffffu;

/// Holds all instances of a scene as one list of world-space triangles: what the solver bakes and every
/// tracer traces. Opaque triangles come first, those of alpha-masked materials behind them; each part is in
/// file order. Panes, which light passes (assets/model/panes.h), are left out. Corner arrays hold three
/// entries per triangle. Counter-clockwise is the front, mirrored instances included, so cross(p1 - p0, p2 -
/// p0) points to the front. No triangle has zero area or a corner beyond kFarthest (scene_limits.h).
struct WorldMesh {
    std::vector<glm::vec3> positions;  // [m]
    std::vector<glm::vec3> normals;    // unit, shading
    std::vector<glm::vec2> lightmapUv; // on the sheet of all pages, [0,1]; row = v * size
    std::vector<glm::vec2> baseUv;     // of the base colour texture, its transform applied
    std::vector<glm::vec2> emissionUv; // of the emission texture
    std::vector<glm::vec2> metallicUv; // of the metallic-roughness texture
    std::vector<glm::vec4> colors;     // COLOR_0, white where the file has none
    std::vector<uint32_t> material;    // per triangle, into Scene::materials; materials.size() is the default
    std::vector<uint32_t> instance;    // per triangle, into Scene::instances
    std::vector<uint32_t> chart;       // per triangle, kNoChart: no lightmap UV, blocks light only
    uint32_t chartCount = 0;           // a chart: triangles of one instance connected through shared UV edges
    uint32_t opaqueCount = 0;          // triangles before the first alpha-masked one
    LightmapPages pages = {};          // of the lightmap
    uint32_t triangleCount() const { return static_cast<uint32_t>(material.size()); }
};

/// Flattens a scene with the atlas it was given. Drops triangles of no area, those that reach too far, panes,
/// and hidden instances. Throws Error where nothing is left.
WorldMesh flatten(const Scene& scene, const LightmapAtlas& atlas);
/// Flattens these instances alone, hidden or not, in ascending order; charts are counted among them. The
/// result may be empty.
WorldMesh flattenInstances(const Scene& scene, const LightmapAtlas& atlas,
                           std::span<const uint32_t> instances);
/// Flattens the panes alone, as far as they are shown, without lightmap UVs: they are drawn and not baked.
/// The result may be empty.
WorldMesh flattenPanes(const Scene& scene);

} // namespace relume
