#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "assets/atlas/world_mesh.h"
#include "renderer/box.h"
#include "renderer/shader_types.h"

namespace relume {

/// Holds a vertex as shaders/gl/scene.vert reads it, in its order.
struct SceneVertex {
    glm::vec3 position; // [m], world space
    glm::vec3 normal;   // unit
    glm::vec2 baseUv, emissionUv, metallicUv, lightmapUv;
    glm::vec4 color;
    uint32_t instance = 0;
    uint32_t mapped = 0; // 1: lightmapUv is one
};

/// Holds triangles of one material and instance, which are drawn at once.
struct SceneDraw {
    uint32_t firstIndex = 0, indexCount = 0;
    uint32_t material = 0; // into Scene::materials; materials.size() is the default
    uint32_t instance = 0; // into Scene::instances
    bool doubleSided = false;
    bool pane = false; // light passes it: what is behind it shows through
    uint32_t mapped =
        shader::kMappedNone; // which of its triangles have lightmap UVs: kMappedNone, Some or All
    Box bounds;
};

/// Holds a scene's triangles in the order in which they are drawn; equal corners share a vertex.
struct SceneGeometry {
    std::vector<SceneVertex> vertices;
    std::vector<uint32_t> indices;
    // Single-sided ones come first, those of a material side by side; panes are behind all others.
    std::vector<SceneDraw> draws;
    Box bounds;
    // This is the square root of lightmap area over surface area, the median over the surface [1/m]; times
    // the lightmap's edge in texels it is the texels per metre. It is 0 without lightmap UVs.
    float medianDensity = 0;
};

/// Makes the geometry of a flattened scene; the scene's panes, which the mesh has not, are added.
SceneGeometry makeGeometry(const Scene& scene, const WorldMesh& mesh);

/// Returns the bounds of all triangles.
Box boundsOf(const WorldMesh& mesh);

} // namespace relume
