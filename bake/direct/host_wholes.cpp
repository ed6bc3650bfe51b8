#include "bake/direct/host_wholes.h"

#include <algorithm>
#include <array>
#include <vector>

namespace relume {
namespace {

using shader::EmitterEdge;
using shader::EmitterPolygon;
using shader::kChunk;
using shader::Patch;
using Lane = std::array<float, kChunk>;

// A chunk by component.
struct Lanes {
    Lane px, py, pz, nx, ny, nz; // position, shading normal
    Lane red{}, green{}, blue{}; // sums over edges, times 2 pi
};

// An edge with what its polygons send.
struct SeenEdge {
    EmitterEdge edge;
    glm::vec3 radiance, beyond; // [cd/m^2], zero where there is no polygon beyond
};

// The loops below have a form that compilers turn into vector code. They are always inlined, to be compiled
// once for each instruction set.

// Tells whether the edge counts for any patch: of one that faces it, or of two alike one alone.
[[gnu::always_inline]] inline bool countsFor(const Lanes& on, const EmitterEdge& edge, bool alike) {
    const EmitterEdge e = edge;
    uint32_t any = 0;
    for (uint32_t i = 0; i < kChunk; ++i) {
        const glm::vec3 p(on.px[i], on.py[i], on.pz[i]);
        const uint32_t faces = glm::dot(e.normal, p) > e.height ? 1 : 0;
        const uint32_t beyond = glm::dot(e.normalBeyond, p) > e.heightBeyond ? 1 : 0;
        any |= alike ? faces ^ beyond : faces | beyond;
    }
    return any != 0;
}

[[gnu::always_inline]] inline void addEdge(const SeenEdge& seen, Lanes& on) {
    const EmitterEdge e = seen.edge;
    const glm::vec3 radiance = seen.radiance, radianceBeyond = seen.beyond;
#pragma GCC ivdep
    for (uint32_t i = 0; i < kChunk; ++i) {
        const glm::vec3 p(on.px[i], on.py[i], on.pz[i]), n(on.nx[i], on.ny[i], on.nz[i]);
        const float faces = glm::dot(e.normal, p) > e.height ? 1.0f : 0.0f;
        const float beyond = glm::dot(e.normalBeyond, p) > e.heightBeyond ? 1.0f : 0.0f;
        const float term = shader::lambertEdge(n, e.from - p, e.along, 1.0f, 1.0f);
        on.red[i] += (faces * radiance.r - beyond * radianceBeyond.r) * term;
        on.green[i] += (faces * radiance.g - beyond * radianceBeyond.g) * term;
        on.blue[i] += (faces * radiance.b - beyond * radianceBeyond.b) * term;
    }
}

[[gnu::always_inline]] inline void addEdges(std::span<const SeenEdge> edges, Lanes& on) {
    for (const SeenEdge& seen : edges)
        if (countsFor(on, seen.edge, seen.radiance == seen.beyond)) addEdge(seen, on);
}

void addEdgesPlain(std::span<const SeenEdge> edges, Lanes& on) {
    addEdges(edges, on);
}
#if defined(__x86_64__)
__attribute__((target("avx2"))) void addEdgesAvx2(std::span<const SeenEdge> edges, Lanes& on) {
    addEdges(edges, on);
}
using AddEdges = void (*)(std::span<const SeenEdge>, Lanes&);
AddEdges chooseAddEdges() {
    return __builtin_cpu_supports("avx2") ? addEdgesAvx2 : addEdgesPlain;
}
#else
auto chooseAddEdges() {
    return addEdgesPlain;
}
#endif

// Returns the light of polygons that may lie across the horizon.
glm::vec3 clippedLight(const HostWholes& work, const glm::vec3& p, const glm::vec3& n) {
    glm::vec3 sum(0.0f);
    for (const EmitterPolygon& e : work.polygons)
        sum += e.radiance * shader::emitterFormFactor(p, n, e);
    return sum;
}

void setLane(Lanes& on, uint32_t i, const glm::vec3& p, const glm::vec3& n) {
    on.px[i] = p.x, on.py[i] = p.y, on.pz[i] = p.z;
    on.nx[i] = n.x, on.ny[i] = n.y, on.nz[i] = n.z;
}

// Returns the light that each lane gets, zero where it is not asked for.
std::array<glm::vec3, kChunk> lightOf(const HostWholes& work, std::span<const SeenEdge> edges,
                                      const std::array<uint32_t, kChunk>& asked, Lanes& on) {
    static const auto add = chooseAddEdges();
    std::array<int, kChunk> side;
    bool above = false;
    for (uint32_t i = 0; i < kChunk; ++i) {
        side[i] =
            shader::sideOfHorizon(work.root, {on.px[i], on.py[i], on.pz[i]}, {on.nx[i], on.ny[i], on.nz[i]});
        above = above || (asked[i] != 0 && side[i] > 0);
    }
    if (above) add(edges, on);
    std::array<glm::vec3, kChunk> light{};
    for (uint32_t i = 0; i < kChunk; ++i) {
        if (asked[i] != 0 && side[i] > 0)
            light[i] = glm::max(0.5f * shader::kInvPi * glm::vec3(on.red[i], on.green[i], on.blue[i]),
                                glm::vec3(0.0f));
        else if (asked[i] != 0 && side[i] == 0)
            light[i] = clippedLight(work, {on.px[i], on.py[i], on.pz[i]}, {on.nx[i], on.ny[i], on.nz[i]});
    }
    return light;
}

void findChunk(const HostWholes& work, std::span<const SeenEdge> edges, uint32_t chunk) {
    const size_t first = size_t{chunk} * kChunk;
    std::array<shader::TexelSpread, kChunk> spreads;
    std::array<uint32_t, kChunk> even{}, curved{}, uneven{}; // 1: the patch is asked for
    for (uint32_t i = 0; i < kChunk; ++i) {
        const Patch& p = work.patches[first + i];
        spreads[i] = shader::texelSpread(p, work.covers ? work.covers[first + i] : shader::PatchCover{});
        if ((p.flags & shader::kPatchSends) == 0) continue;
        const uint32_t kind =
            shader::unevenness(spreads[i].size, shader::nodeDistance(spreads[i].middle, work.root));
        (kind == shader::kLightEven ? even : kind == shader::kLightCurved ? curved : uneven)[i] = 1;
    }
    // Returns the light that the patches asked for get at a point of each.
    const auto lightAt = [&](const std::array<uint32_t, kChunk>& asked, const auto& pointOf) {
        Lanes on;
        for (uint32_t i = 0; i < kChunk; ++i)
            setLane(on, i, pointOf(spreads[i]), work.patches[first + i].shading);
        return lightOf(work, edges, asked, on);
    };
    std::array<glm::vec3, kChunk> light = lightAt(even, [](const auto& t) { return t.middle; });
    const bool anyCurved = std::find(curved.begin(), curved.end(), 1u) != curved.end();
    for (uint32_t k = 0; anyCurved && k < shader::kSpreadPoints; ++k) {
        const auto part = lightAt(curved, [&](const auto& t) { return shader::spreadPoint(t, k); });
        for (uint32_t i = 0; i < kChunk; ++i)
            light[i] += part[i] / static_cast<float>(shader::kSpreadPoints);
    }
    for (uint32_t i = 0; i < kChunk; ++i)
        work.wholes[first + i] = glm::vec4(light[i], uneven[i] != 0 ? 1.0f : 0.0f);
}

} // namespace

void findWholes(WorkerPool& pool, const HostWholes& work) {
    std::vector<SeenEdge> edges;
    for (const EmitterEdge& edge : work.edges) {
        const bool open = edge.polygonBeyond == edge.polygon;
        edges.push_back({edge, work.polygons[edge.polygon].radiance,
                         open ? glm::vec3(0.0f) : work.polygons[edge.polygonBeyond].radiance});
    }
    pool.run(work.range.count, [&](uint32_t chunk) { findChunk(work, edges, work.range.first + chunk); });
}

} // namespace relume
