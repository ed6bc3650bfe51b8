#pragma once

#include <vector>

#include "assets/atlas/world_mesh.h"
#include "bake/base/shader_types.h"
#include "bake/lights/light_source.h"

namespace relume {

/// All mesh lights, as polygons to be sampled and the tree to choose among them
/// (shaders/lib/light/pick_emitter.glsl): what the direct light is made of.
struct EmitterSet {
    std::vector<shader::EmitterPolygon> polygons;
    /// The first one is the root; never empty: without mesh lights there is a root of power 0, at which every
    /// pick ends.
    std::vector<shader::EmitterNode> nodes;
    double power = 0; // area times mean of the radiance's components, all polygons [cd]
};

/// One of the mesh lights that are asked for.
struct EmitterChoice {
    LightKey key;
    glm::vec3 factor{1.0f}; // in place of the material's emission [cd/m^2]

    bool operator==(const EmitterChoice&) const = default;
};

struct EmitterDesc {
    uint32_t size = 512;                  // lightmap edge [texels]: how far rays end above a surface
    uint32_t maxPieces = 32'768;          // that textured emission may be split into, all surfaces together
    std::vector<EmitterChoice> only = {}; // only these, in ascending order of keys; empty: all
};

/// Makes polygons for every emitting triangle of the mesh, whether or not it has a place in the lightmap. Two
/// that form a plane convex quadrilateral become one; a double-sided one shines from a second, flipped
/// polygon. Where a texture or a mask varies the emission, polygons are pieces of one radiance; black ones
/// are left out. Logs how many there are, and warns when maxPieces was reached.
EmitterSet buildEmitters(const Scene& scene, const WorldMesh& mesh, const EmitterDesc& desc);

} // namespace relume
