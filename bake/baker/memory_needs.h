#pragma once

#include "assets/atlas/world_mesh.h"
#include "assets/model/scene.h"
#include "bake/baker/bake_settings.h"
#include "bake/solver/solver_extent.h"

namespace relume {

/// Holds what a scene brings along that takes device memory by itself.
struct SceneExtent {
    uint64_t triangles = 0;
    uint64_t pictureBytes = 0; // of textures, without mips
    uint64_t skyPixels = 0, skyRows = 0;
    LightmapPages pages = {}; // for which its lightmap coordinates are
};
SceneExtent extentOf(const Scene& scene, const WorldMesh& mesh);
/// Returns the same of a scene before it is flattened, with all its triangles, for a lightmap of these pages.
SceneExtent extentOf(const Scene& scene, const LightmapPages& pages);

/// The device bytes of a bake, by what takes them. Caches that grow as long as there is memory are not
/// counted, but for the links of one sample pass.
struct MemoryNeeds {
    uint64_t cit = 0;     // images and buffers of the CIT pass, which are gone before the rest comes
    uint64_t surface = 0; // patches and their light
    uint64_t trace = 0;   // the tracer's tables and voxels
    uint64_t inside = 0;  // of the search for patches inside something, gone before the solver comes
    uint64_t solver = 0;
    uint64_t edits = 0;   // to follow edits of colours and of objects
    uint64_t probes = 0;  // with a tracer of their own, beside all that stays
    uint64_t host = 0;    // a software device's memory is the host's, which holds much of this once more
    uint64_t spilled = 0; // of the surface's and the solver's buffers in the host's memory; not in total()

    /// Returns the most that is taken of the device's memory at a time.
    uint64_t total() const;
};
/// Returns what a bake needs; `solver.texels` counts those of the sheet of all pages.
MemoryNeeds memoryNeeds(const BakeSettings& settings, const SceneExtent& scene, const SolverExtent& solver);
/// Returns what a bake needs at most: every texel is covered, and what is not known of the scene is as large
/// as it can get. `software` says that the device is the CPU.
MemoryNeeds mostMemoryNeeds(const BakeSettings& settings, const SceneExtent& scene, bool software);

/// Returns the most bytes of the host's memory that a bake's surfaces take at a time: what the CIT pass
/// leaves, and the patches that are made of it, when every texel is covered. A device's own memory is not
/// counted, but so many bytes that it spills to the host once the patches are made.
uint64_t hostNeeds(const BakeSettings& settings, const SceneExtent& scene, uint64_t spilled = 0);

/// Tells whether rays march through voxels, all or some of them.
bool usesVoxels(const BakeSettings& settings);
/// Tells whether the bake can follow edits of objects.
bool followsObjects(const BakeSettings& settings);

} // namespace relume
