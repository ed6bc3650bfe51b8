#include "bake/baker/memory_needs.h"

#include <algorithm>

#include "bake/validity/cover_search.h"
#include "bake/validity/inside_search.h"
#include "bake/baker/make_solver.h"
#include "bake/baker/move_search.h"
#include "bake/pairs/pair_memory.h"
#include "bake/probes/probe_light.h"
#include "bake/surface/light_buffers.h"
#include "bake/surface/surface_colours.h"

namespace relume {
namespace {

// The images of the CIT pass have so many bytes per texel; the largest is read back beside them.
constexpr uint64_t kCitTexelBytes = 4 * sizeof(glm::vec4) + sizeof(uint32_t) + sizeof(glm::vec4);
// Corners, hit table, and the acceleration structure while it is built.
constexpr uint64_t kTriangleBytes = 400;
// The host's copies of a patch and of its light.
constexpr uint64_t kHostBytes = 216;
constexpr uint64_t kPictureTexelBytes = 4;
// Texels as the CIT pass leaves them (TextureGroup), the share that is solid included, which levels without
// masks do not have. Each image is read back through a copy.
constexpr uint64_t kTexelBytes = 4 * sizeof(glm::vec4) + sizeof(uint32_t) + sizeof(float);
constexpr uint64_t kReadBackBytes = sizeof(glm::vec4);
// Whose patch a texel is, and the patches with all that belongs to them (PatchSet).
constexpr uint64_t kTableBytes = sizeof(uint32_t);
constexpr uint64_t kPatchBytes = sizeof(shader::Patch) + sizeof(shader::PatchEdges) +
                                 sizeof(shader::PatchCover) + 4 * sizeof(glm::vec4) + 4 * sizeof(uint32_t);
// The light that is read back, and the lightmap and the map of errors that are made of it.
constexpr uint64_t kResultBytes = 3 * sizeof(glm::vec4);

// Embree's tables are the host's own.
bool tracesOnHost(const BakeSettings& settings, bool software) {
    return software && (settings.tracer == TracerKind::Auto || settings.tracer == TracerKind::Embree);
}

// Probes trace the same triangles once more. A software device's memory also has the light that they see and
// the copies of patches and triangles that their tracer is built from.
uint64_t probeNeeds(const BakeSettings& settings, const SceneExtent& scene, const SolverExtent& solver,
                    uint64_t tables) {
    const ProbeExtent& probes = settings.probes;
    if (probes.count == 0) return 0;
    const uint64_t triangles = scene.triangles * kTriangleBytes;
    uint64_t bytes = probeTracerBytes(probes, solver.patches()) + triangles;
    if (!tracesOnHost(settings, solver.software)) bytes += tables;
    if (!solver.software) return bytes;
    const uint64_t lights = std::min<uint64_t>(probes.lights, probeLightsAtOnce(solver.patches()));
    return bytes + triangles + tables +
           solver.patches() * (sizeof(shader::Patch) + lights * sizeof(glm::vec4));
}

SceneExtent extentWith(uint64_t triangles, const Scene& scene, const LightmapPages& pages) {
    SceneExtent extent{.triangles = triangles,
                       .skyPixels = uint64_t{scene.sky.width} * scene.sky.height,
                       .skyRows = scene.sky.height,
                       .pages = pages};
    for (const Image& image : scene.images)
        extent.pictureBytes += uint64_t{image.width} * image.height * kPictureTexelBytes;
    return extent;
}

} // namespace

SceneExtent extentOf(const Scene& scene, const WorldMesh& mesh) {
    return extentWith(mesh.triangleCount(), scene, mesh.pages);
}

SceneExtent extentOf(const Scene& scene, const LightmapPages& pages) {
    uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) {
        if (instance.hidden) continue;
        for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
            triangles += primitive.indices.size() / 3;
    }
    return extentWith(triangles, scene, pages);
}

bool usesVoxels(const BakeSettings& settings) {
    return settings.tracer == TracerKind::Voxel || settings.voxels.ratio > 0;
}

bool followsObjects(const BakeSettings& settings) {
    const SolverSettings& solver = settings.solver;
    return solver.layers.on && !solver.transport.rtrad && !usesVoxels(settings);
}

uint64_t MemoryNeeds::total() const {
    return std::max(cit, surface + trace + std::max(inside, solver + edits + probes) + host);
}

MemoryNeeds memoryNeeds(const BakeSettings& settings, const SceneExtent& scene, const SolverExtent& solver) {
    const uint64_t triangles = scene.triangles * kTriangleBytes;
    // A picture's mips take a third as much again.
    const uint64_t pictures = scene.pictureBytes + scene.pictureBytes / 3;
    // Whose a texel and whose a patch is.
    const uint64_t tables = solver.texels * sizeof(uint32_t) + solver.patches() * sizeof(uint32_t);
    MemoryNeeds needs;
    needs.cit = solver.texels * kCitTexelBytes + triangles + pictures;
    const SpilledBytes light =
        LightBuffers::bytes(solver.chunkCount, startsAllOver(settings.solver), settings.solver.spill);
    const SpilledBytes own = solverBytes(solver, settings.solver);
    needs.surface = light.device;
    needs.spilled = light.host + own.host;
    needs.trace = triangles;
    if (!tracesOnHost(settings, solver.software)) needs.trace += tables;
    // Its pass has the tables once more.
    if (usesVoxels(settings)) needs.trace += VoxelMap::bytes(settings.voxels.resolution) + 2 * tables;
    if (!settings.solver.transport.rtrad)
        needs.inside = std::max(
            insideBytes(solver.chunkCount, solver.software),
            startsAllOver(settings.solver) ? coverSearchBytes(solver.chunkCount, solver.software) : 0);
    needs.solver = own.device;
    if (settings.solver.layers.on) needs.edits = SurfaceColours::bytes(solver.chunkCount);
    if (followsObjects(settings)) needs.edits += MoveSearch::bytes(solver.chunkCount, solver.software);
    needs.probes = probeNeeds(settings, scene, solver, tables);
    if (solver.software)
        needs.host = kHostBytes * solver.patches() + pairSenderBytes(solver, settings.solver);
    return needs;
}

MemoryNeeds mostMemoryNeeds(const BakeSettings& settings, const SceneExtent& scene, bool software) {
    const uint64_t sheet = scene.pages.sheetOf(settings.size), texels = sheet * sheet;
    const uint64_t patches = uint64_t{scene.pages.count} * settings.size * settings.size;
    return memoryNeeds(settings, scene,
                       {.chunkCount = static_cast<uint32_t>(patches / shader::kChunk + 1),
                        .texels = texels,
                        .software = software,
                        .skyPixels = scene.skyPixels,
                        .skyRows = scene.skyRows});
}

uint64_t hostNeeds(const BakeSettings& settings, const SceneExtent& scene, uint64_t spilled) {
    const uint64_t sheet = scene.pages.sheetOf(settings.size), texels = sheet * sheet;
    const uint64_t patches = uint64_t{scene.pages.count} * settings.size * settings.size;
    const uint64_t read = texels * (kTexelBytes + kReadBackBytes);
    const uint64_t made = texels * (kTexelBytes + kTableBytes) + patches * kPatchBytes;
    const uint64_t baked =
        spilled > 0 ? texels * (kTableBytes + kResultBytes) + patches * kPatchBytes + spilled : 0;
    return std::max({read, made, baked});
}

} // namespace relume
