#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "assets/atlas/uv_grid.h"
#include "assets/base/worker_pool.h"
#include "assets/model/scene.h"

namespace relume {

constexpr double kMaxOverlap = 0.01;   // that a lightmap's UVs may have, of their area
constexpr uint32_t kAtlasCells = 2048; // to a side of the grid that measures whole atlases

/// Tells what one UV set of one mesh is worth as a lightmap atlas.
struct SetQuality {
    bool usable = false;
    bool complete = false; // every primitive has the set
    std::string fault;     // why it is not usable
    glm::dvec2 low{0.0}, high{0.0};
    double uvArea = 0.0;
    uint64_t visits = 0; // of cells, to find overlaps
};

/// Holds the set chosen for a mesh; texCoord -1: none.
struct MeshChoice {
    int texCoord = -1;
    SetQuality quality;
    uint64_t visits = 0;                    // of all sets that were looked at
    std::vector<std::string> warnings = {}; // what is to be said of it, as sentences without their subject
};

/// Tells whether a primitive has triangles, with UVs of this set.
bool hasUvTriangles(const Primitive& primitive, int set);

/// Some triangles of one UV set of a primitive.
struct UvRun {
    const Primitive* primitive;
    const std::vector<glm::vec2>* uvs;
    size_t first, last;
};

/// Appends a mesh's triangles that have the set, in runs that are worth a thread's while.
void addRuns(const Mesh& mesh, int set, std::vector<UvRun>& runs);

/// Adds triangles, which a pool's threads share, as long as the grid can still say that they do not overlap:
/// each may cover all cells, so that many triangles, or meshes, of the same UVs would cost their product.
void addWhileFree(UvGrid& grid, std::span<const UvRun> runs, WorkerPool& pool);

/// Tells of each mesh whether an instance uses it and it has a primitive.
std::vector<bool> usedMeshes(const Scene& scene);

/// Chooses the UV set of each used mesh: TEXCOORD_1, else TEXCOORD_0 where it is a valid atlas.
std::vector<MeshChoice> chooseSets(const Scene& scene, WorkerPool& pool);

/// Returns how many threads the triangles of all meshes are worth.
uint32_t threadsFor(const std::vector<Mesh>& meshes);

/// Returns the UV set that all of a mesh's primitives have and that is a valid atlas by itself: 1, else 0,
/// else -1.
int lightmapSet(const Mesh& mesh);

/// Returns how many meshes that instances use have a surface and no such set.
size_t countUnmapped(const Scene& scene);

} // namespace relume
