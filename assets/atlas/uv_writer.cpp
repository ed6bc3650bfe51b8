#include "assets/atlas/uv_writer.h"

#include "assets/base/numbering.h"

#include <algorithm>
#include <array>
#include <bit>

namespace relume {

namespace {

/// A vertex with its place in the atlas: where a tube is cut open, it has two in one chart.
struct PlacedVertex {
    uint32_t index, chart;
    glm::vec2 uv;
    bool operator==(const PlacedVertex&) const = default;
};

uint64_t hashOf(const PlacedVertex& vertex) {
    const uint64_t place =
        (uint64_t{std::bit_cast<uint32_t>(vertex.uv.x)} << 32) | std::bit_cast<uint32_t>(vertex.uv.y);
    return mixBits(mixBits((uint64_t{vertex.index} << 32) | vertex.chart) ^ place);
}

template<typename T>
void pickVertices(std::vector<T>& values, const Numbering<PlacedVertex>& vertices) {
    if (values.empty()) return;
    std::vector<T> out(vertices.size());
    for (uint32_t i = 0; i < out.size(); ++i)
        out[i] = values[vertices.key(i).index];
    values = std::move(out);
}

/// Writes the UVs of the triangles from `first` on.
void applyUvs(const CornerUvs& uvs, size_t first, Primitive& primitive) {
    Numbering<PlacedVertex> vertices(primitive.indices.size());
    std::vector<glm::vec2> placed;
    for (size_t i = 0; i < primitive.indices.size(); ++i) {
        const size_t triangle = first + i / 3;
        const PlacedVertex vertex{primitive.indices[i], uvs.chart[triangle], uvs.uv[3 * triangle + i % 3]};
        primitive.indices[i] = vertices(vertex, hashOf(vertex));
        if (primitive.indices[i] == placed.size()) placed.push_back(vertex.uv);
    }
    pickVertices(primitive.positions, vertices);
    pickVertices(primitive.normals, vertices);
    pickVertices(primitive.texCoord0, vertices);
    pickVertices(primitive.texCoord2, vertices);
    pickVertices(primitive.colors, vertices);
    primitive.texCoord1 = std::move(placed);
}

} // namespace

CornerUvs cornerUvs(const std::vector<PlanarChart>& charts, const ChartPlace* places, double cells,
                    double border, size_t triangles) {
    CornerUvs uvs;
    uvs.uv.resize(3 * triangles);
    uvs.chart.assign(triangles, kNoNumber);
    for (size_t i = 0; i < charts.size(); ++i) {
        const PlanarChart& chart = charts[i];
        for (size_t t = 0; t < chart.triangles.size(); ++t) {
            uvs.chart[chart.triangles[t]] = static_cast<uint32_t>(i);
            for (size_t k = 0; k < 3; ++k) {
                const glm::dvec2 uv = (places[i].texelOf(chart.uv[3 * t + k]) + border) / cells;
                uvs.uv[3 * chart.triangles[t] + k] = glm::clamp(glm::vec2(uv), 0.0f, 1.0f);
            }
        }
    }
    return uvs;
}

Mesh withUvs(const Mesh& mesh, const CornerUvs& uvs) {
    Mesh result = mesh;
    size_t first = 0;
    for (Primitive& primitive : result.primitives) {
        const size_t count = primitive.indices.size() / 3;
        applyUvs(uvs, first, primitive);
        first += count;
    }
    return result;
}

namespace {

/// Tells which sets of UVs a primitive's textures use, kept ones last. Where these ask for a third set, what
/// bakes need goes before them.
std::array<bool, 3> usedSets(const Scene& scene, const Primitive& primitive) {
    std::array<bool, 3> baked{}, all{};
    if (primitive.material < 0) return baked;
    const Material& material = scene.materials[static_cast<size_t>(primitive.material)];
    for (const TextureRef* use : textureUses(material)) {
        if (use->texture < 0) continue;
        const auto set = static_cast<size_t>(setOf(primitive.movedUvs, *use));
        const bool kept = use == &material.normalMap.use || use == &material.occlusionMap.use;
        all[set] = true;
        if (!kept) baked[set] = true;
    }
    return all[0] && all[1] && all[2] ? baked : all;
}

} // namespace

bool canFreeSecondSet(const Scene& scene, const Mesh& mesh) {
    return std::none_of(mesh.primitives.begin(), mesh.primitives.end(), [&](const Primitive& primitive) {
        const std::array<bool, 3> used = usedSets(scene, primitive);
        return used[0] && used[1] && used[2];
    });
}

void freeSecondSet(const Scene& scene, Mesh& mesh) {
    for (Primitive& primitive : mesh.primitives) {
        const std::array<bool, 3> used = usedSets(scene, primitive);
        if (!used[1] || (used[0] && used[2])) continue;
        primitive.movedUvs = used[0] ? 2 : 0;
        (used[0] ? primitive.texCoord2 : primitive.texCoord0) = primitive.texCoord1;
    }
}

} // namespace relume
