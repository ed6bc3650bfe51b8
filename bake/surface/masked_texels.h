#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "assets/atlas/world_mesh.h"
#include "bake/surface/surface_reader.h"
#include "bake/surface/texture_group.h"

namespace relume {

class WorkerPool;

/// The solid part of a masked triangle. Shares and colours are means over places in it, which depend on its
/// place in the lightmap alone.
struct SolidPart {
    float share = 0.0f;                // of the triangle's area
    SurfaceColour colour;              // of what is solid
    glm::vec3 place = glm::vec3(0.0f); // the solid place nearest the middle, as weights of the corners
};
/// Returns a triangle's, in a lightmap with this edge [texels].
SolidPart solidPart(const SurfaceReader& reader, const WorldMesh& mesh, uint32_t triangle, uint32_t size);
/// Returns the share alone, which takes less time.
float solidShare(const SurfaceReader& reader, const WorldMesh& mesh, uint32_t triangle, uint32_t size);

/// Looks through the texels of masked triangles, which the CIT pass draws as if they had no holes. A texel in
/// which nothing is solid becomes empty. All others get the colours of what is solid there and, as
/// group.solid, its share; where their own point lies in a hole it moves to the solid place nearest to it.
/// The result does not depend on the number of threads.
void findSolidTexels(TextureGroup& group, const Scene& scene, const WorldMesh& mesh, WorkerPool& pool);

} // namespace relume
