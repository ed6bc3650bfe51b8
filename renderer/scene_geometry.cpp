#include "renderer/scene_geometry.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>
#include <utility>

namespace relume {
namespace {

static_assert(sizeof(SceneVertex) == 80); // no padding: vertices are compared and hashed by their bytes

/// Gives equal vertices the same number.
class Welder {
public:
    Welder(std::vector<SceneVertex>& vertices, size_t corners)
        : vertices_(vertices), slots_(std::bit_ceil(2 * corners + 1), kEmpty) {}

    uint32_t add(const SceneVertex& vertex) {
        size_t slot = hash(vertex) & (slots_.size() - 1);
        for (; slots_[slot] != kEmpty; slot = (slot + 1) & (slots_.size() - 1))
            if (std::memcmp(&vertices_[slots_[slot]], &vertex, sizeof(vertex)) == 0) return slots_[slot];
        slots_[slot] = static_cast<uint32_t>(vertices_.size());
        vertices_.push_back(vertex);
        return slots_[slot];
    }

private:
    static constexpr uint32_t kEmpty = 0xffffffffu;

    // Hashes by FNV-1a, word by word, and folds the high bits down to where the table looks.
    static size_t hash(const SceneVertex& vertex) {
        uint32_t words[sizeof(vertex) / sizeof(uint32_t)];
        std::memcpy(words, &vertex, sizeof(vertex));
        uint64_t h = 0xcbf29ce484222325u;
        for (const uint32_t word : words)
            h = (h ^ word) * 0x100000001b3u;
        return static_cast<size_t>(h ^ (h >> 32));
    }

    std::vector<SceneVertex>& vertices_;
    std::vector<uint32_t> slots_;
};

bool isDoubleSided(const Scene& scene, uint32_t material) {
    return material < scene.materials.size() && scene.materials[material].doubleSided;
}

SceneVertex vertexOf(const WorldMesh& mesh, uint32_t triangle, uint32_t corner) {
    const size_t i = size_t{3} * triangle + corner;
    SceneVertex vertex;
    vertex.position = mesh.positions[i];
    vertex.normal = mesh.normals[i];
    vertex.baseUv = mesh.baseUv[i];
    vertex.emissionUv = mesh.emissionUv[i];
    vertex.metallicUv = mesh.metallicUv[i];
    vertex.lightmapUv = mesh.lightmapUv[i];
    vertex.color = mesh.colors[i];
    vertex.instance = mesh.instance[triangle];
    vertex.mapped = mesh.chart[triangle] != kNoChart ? 1 : 0;
    return vertex;
}

// Returns what a draw's triangles have together; `before` is what the first ones have.
uint32_t mappedWith(uint32_t before, bool first, bool mapped) {
    const uint32_t own = mapped ? shader::kMappedAll : shader::kMappedNone;
    return first || before == own ? own : shader::kMappedSome;
}

float medianDensity(const WorldMesh& mesh) {
    std::vector<std::pair<double, double>> densities; // and the area that has it
    double total = 0;
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t) {
        if (mesh.chart[t] == kNoChart) continue;
        const size_t i = size_t{3} * t;
        const glm::dvec3 p = mesh.positions[i], a = glm::dvec3(mesh.positions[i + 1]) - p,
                         b = glm::dvec3(mesh.positions[i + 2]) - p;
        const glm::dvec2 uv = mesh.lightmapUv[i], c = glm::dvec2(mesh.lightmapUv[i + 1]) - uv,
                         d = glm::dvec2(mesh.lightmapUv[i + 2]) - uv;
        const double area = glm::length(glm::cross(a, b));
        densities.emplace_back(std::sqrt(std::abs(c.x * d.y - c.y * d.x) / area), area);
        total += area;
    }
    std::sort(densities.begin(), densities.end());
    double below = 0;
    for (const auto& [density, area] : densities) {
        below += area;
        if (below >= 0.5 * total) return static_cast<float>(density);
    }
    return 0.0f;
}

// Adds the draws of all triangles of a mesh.
void addDraws(const Scene& scene, const WorldMesh& mesh, Welder& welder, SceneGeometry& geometry) {
    std::vector<uint32_t> order(mesh.triangleCount());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t t) {
        return std::tuple(isDoubleSided(scene, mesh.material[t]), mesh.material[t], mesh.instance[t]);
    };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (size_t i = 0; i < order.size(); ++i) {
        const uint32_t triangle = order[i];
        if (i == 0 || key(triangle) != key(order[i - 1])) {
            geometry.draws.push_back({.firstIndex = static_cast<uint32_t>(geometry.indices.size()),
                                      .indexCount = 0,
                                      .material = mesh.material[triangle],
                                      .instance = mesh.instance[triangle],
                                      .doubleSided = isDoubleSided(scene, mesh.material[triangle]),
                                      .pane = false,
                                      .mapped = shader::kMappedNone,
                                      .bounds = {}});
        }
        SceneDraw& draw = geometry.draws.back();
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const SceneVertex vertex = vertexOf(mesh, triangle, corner);
            geometry.indices.push_back(welder.add(vertex));
            draw.bounds.add(vertex.position);
        }
        draw.mapped = mappedWith(draw.mapped, draw.indexCount == 0, mesh.chart[triangle] != kNoChart);
        draw.indexCount += 3;
    }
}

} // namespace

SceneGeometry makeGeometry(const Scene& scene, const WorldMesh& mesh) {
    const WorldMesh panes = flattenPanes(scene);
    SceneGeometry geometry;
    geometry.indices.reserve(mesh.positions.size() + panes.positions.size());
    Welder welder(geometry.vertices, mesh.positions.size() + panes.positions.size());
    addDraws(scene, mesh, welder, geometry);
    const size_t solid = geometry.draws.size();
    addDraws(scene, panes, welder, geometry);
    for (size_t i = solid; i < geometry.draws.size(); ++i)
        geometry.draws[i].pane = true;
    for (const SceneDraw& draw : geometry.draws)
        geometry.bounds.add(draw.bounds);
    geometry.medianDensity = medianDensity(mesh);
    return geometry;
}

Box boundsOf(const WorldMesh& mesh) {
    Box box;
    for (const glm::vec3& position : mesh.positions)
        box.add(position);
    return box;
}

} // namespace relume
