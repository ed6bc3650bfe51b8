#include "assets/atlas/uv_sets.h"

#include "assets/base/watch.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

namespace relume {
namespace {

constexpr double kUvTolerance = 1e-4; // exporters' rounding; below half a texel of a 4096 atlas
constexpr double kMinUvExtent = 1e-6; // below it a set is a point, as of a mesh never unwrapped

template<typename Visit>
void forEachTriangle(const UvRun& run, const Visit& visit) {
    for (size_t i = run.first; i < run.last; ++i) {
        const uint32_t* t = &run.primitive->indices[3 * i];
        visit(glm::dvec2((*run.uvs)[t[0]]), glm::dvec2((*run.uvs)[t[1]]), glm::dvec2((*run.uvs)[t[2]]));
    }
}

double areaOf(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const glm::dvec2 x = b - a, y = c - a;
    return 0.5 * std::abs(x.x * y.y - x.y * y.x);
}

SetQuality assess(const Mesh& mesh, int set, WorkerPool& pool) {
    SetQuality quality;
    const auto has = [set](const Primitive& p) { return hasUvTriangles(p, set); };
    if (std::none_of(mesh.primitives.begin(), mesh.primitives.end(), has)) {
        quality.fault = fmt::format("has no TEXCOORD_{}", set);
        return quality;
    }
    quality.complete = std::all_of(mesh.primitives.begin(), mesh.primitives.end(),
                                   [&](const Primitive& p) { return p.indices.empty() || has(p); });
    quality.low = glm::dvec2(std::numeric_limits<double>::max());
    quality.high = -quality.low;
    size_t triangles = 0;
    std::vector<UvRun> runs;
    addRuns(mesh, set, runs);
    for (const UvRun& run : runs) {
        forEachTriangle(run, [&](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
            quality.low = glm::min(quality.low, glm::min(a, glm::min(b, c)));
            quality.high = glm::max(quality.high, glm::max(a, glm::max(b, c)));
            quality.uvArea += areaOf(a, b, c);
        });
        triangles += run.last - run.first;
    }
    const glm::dvec2 extent = quality.high - quality.low;
    if (!(std::min(quality.low.x, quality.low.y) >= -kUvTolerance) ||
        !(std::max(quality.high.x, quality.high.y) <= 1.0 + kUvTolerance)) {
        quality.fault = fmt::format("has a TEXCOORD_{} outside [0,1]", set);
        return quality;
    }
    if (std::min(extent.x, extent.y) < kMinUvExtent) {
        quality.fault = fmt::format("has a TEXCOORD_{} without area", set);
        return quality;
    }
    // A coarse grid sees few texels of charts that lie far apart: a finer one has the last word.
    bool overlaps = true;
    for (uint32_t cells = UvGrid::sizeFor(triangles); overlaps; cells = kAtlasCells) {
        UvGrid grid(cells, quality.low, quality.high);
        addWhileFree(grid, runs, pool);
        quality.visits += grid.visits();
        overlaps = grid.overlaps(kMaxOverlap);
        if (cells == kAtlasCells) break;
    }
    if (overlaps) {
        quality.fault = fmt::format("has a TEXCOORD_{} overlapping itself by more than 1 %", set);
        return quality;
    }
    quality.usable = true;
    return quality;
}

MeshChoice chooseSet(const Mesh& mesh, WorkerPool& pool) {
    SetQuality second = assess(mesh, 1, pool);
    if (second.usable && second.complete) return {.texCoord = 1, .quality = second, .visits = second.visits};
    SetQuality first = assess(mesh, 0, pool);
    const uint64_t visits = first.visits + second.visits;
    const bool takeFirst = first.usable && (first.complete || !second.usable);
    std::vector<std::string> warnings;
    if (takeFirst && !second.fault.empty() && second.fault != "has no TEXCOORD_1")
        warnings.push_back(second.fault + ": TEXCOORD_0 is taken instead");
    MeshChoice choice = takeFirst       ? MeshChoice{.texCoord = 0, .quality = first}
                        : second.usable ? MeshChoice{.texCoord = 1, .quality = second}
                                        : MeshChoice{.texCoord = -1, .quality = second};
    if (choice.texCoord < 0)
        choice.quality.fault = second.fault == "has no TEXCOORD_1" && first.fault != "has no TEXCOORD_0"
                                   ? second.fault + " and " + first.fault
                                   : second.fault;
    if (choice.texCoord >= 0 && !choice.quality.complete)
        warnings.push_back(
            fmt::format("has parts without TEXCOORD_{}, which block light only: run 'relume unwrap' or "
                        "leave out --no-unwrap",
                        choice.texCoord));
    choice.visits = visits;
    choice.warnings = std::move(warnings);
    return choice;
}

int lightmapSet(const Mesh& mesh, WorkerPool& pool) {
    for (int set : {1, 0}) {
        const SetQuality quality = assess(mesh, set, pool);
        if (quality.usable && quality.complete) return set;
    }
    return -1;
}

bool hasSurface(const Mesh& mesh) {
    for (const Primitive& primitive : mesh.primitives)
        for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            const auto corner = [&](size_t k) { return primitive.positions[primitive.indices[i + k]]; };
            const glm::vec3 a = corner(0);
            if (glm::cross(corner(1) - a, corner(2) - a) != glm::vec3(0.0f)) return true;
        }
    return false;
}

} // namespace

bool hasUvTriangles(const Primitive& primitive, int set) {
    return !primitive.indices.empty() && uvSet(primitive, set).size() == primitive.positions.size();
}

void addRuns(const Mesh& mesh, int set, std::vector<UvRun>& runs) {
    constexpr size_t kOfRun = 4096; // triangles
    for (const Primitive& primitive : mesh.primitives) {
        if (!hasUvTriangles(primitive, set)) continue;
        const size_t count = primitive.indices.size() / 3;
        for (size_t first = 0; first < count; first += kOfRun)
            runs.push_back({&primitive, &uvSet(primitive, set), first, std::min(count, first + kOfRun)});
    }
}

void addWhileFree(UvGrid& grid, std::span<const UvRun> runs, WorkerPool& pool) {
    const double most = kMaxOverlap * static_cast<double>(grid.cells());
    if (pool.size() == 1) { // cells that nobody else adds to take a fifth of the time
        for (const UvRun& run : runs)
            forEachTriangle(run, [&](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
                if (static_cast<double>(grid.overlapped()) <= most) grid.add(a, b, c);
            });
        return;
    }
    std::mutex mutex; // of the grid's counts
    std::atomic<uint64_t> overlapped{grid.overlapped()};
    pool.run(static_cast<uint32_t>(runs.size()), [&](uint32_t i) {
        UvGrid::Added added;
        forEachTriangle(runs[i], [&](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
            if (static_cast<double>(overlapped.load(std::memory_order_relaxed)) > most) return;
            const uint64_t before = added.overlapped;
            grid.addBeside(a, b, c, added);
            if (added.overlapped > before) overlapped += added.overlapped - before;
        });
        const std::lock_guard lock(mutex);
        grid.count(added);
    });
}

std::vector<bool> usedMeshes(const Scene& scene) {
    std::vector<bool> used(scene.meshes.size(), false);
    for (const Instance& instance : scene.instances) {
        const auto mesh = static_cast<size_t>(instance.mesh);
        used[mesh] = !scene.meshes[mesh].primitives.empty();
    }
    return used;
}

std::vector<MeshChoice> chooseSets(const Scene& scene, WorkerPool& pool) {
    const std::vector<bool> used = usedMeshes(scene);
    std::vector<MeshChoice> choices(used.size());
    runWatched(&pool, "atlas", static_cast<uint32_t>(used.size()), [&](uint32_t mesh) {
        if (used[mesh]) choices[mesh] = chooseSet(scene.meshes[mesh], pool);
    });
    return choices;
}

uint32_t threadsFor(const std::vector<Mesh>& meshes) {
    constexpr size_t kOfThread = size_t{1} << 14; // triangles: fewer take no longer than a thread's start
    size_t triangles = 0;
    for (const Mesh& mesh : meshes)
        for (const Primitive& primitive : mesh.primitives)
            triangles += primitive.indices.size() / 3;
    return static_cast<uint32_t>(std::min<size_t>(WorkerPool::defaultSize(), 1 + triangles / kOfThread));
}

size_t countUnmapped(const Scene& scene) {
    const std::vector<bool> used = usedMeshes(scene);
    std::atomic<size_t> count{0};
    WorkerPool pool(threadsFor(scene.meshes));
    runWatched(&pool, "atlas", static_cast<uint32_t>(used.size()), [&](uint32_t i) {
        const Mesh& mesh = scene.meshes[i];
        if (used[i] && hasSurface(mesh) && lightmapSet(mesh, pool) < 0) ++count;
    });
    return count;
}

int lightmapSet(const Mesh& mesh) {
    WorkerPool alone(1);
    return lightmapSet(mesh, alone);
}

} // namespace relume
