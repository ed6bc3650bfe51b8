#pragma once

#include <string>
#include <vector>

#include "assets/atlas/lightmap_atlas.h"
#include "assets/model/scene.h"

namespace relume {

/// The facts that `relume info` tells about a scene.
struct SceneInfo {
    uint32_t triangles = 0, maskedTriangles = 0, droppedTriangles = 0;
    glm::vec3 low{0.0f}, high{0.0f}; // bounds [m]
    double area = 0;                 // [m^2]

    uint32_t emitters = 0;         // primitives of instances with emission
    double emitterArea = 0;        // [m^2], of one side
    glm::dvec3 emitted{0.0};       // area x emission [cd] of all sides that emit, textures not counted in
    bool texturedEmitters = false; // then `emitted` is an upper bound

    bool mapped = false; // there are usable lightmap UVs; if not, what follows is empty
    LightmapAtlas atlas;
    AtlasStatistics statistics;
    uint32_t charts = 0;
    std::vector<std::string> warnings; // of file and atlas, and about what in a bake would surprise
};

/// Measures a scene for a lightmap of size x size texels. Throws Error when it has no triangle at all.
SceneInfo inspectScene(const Scene& scene, uint32_t size);

} // namespace relume
