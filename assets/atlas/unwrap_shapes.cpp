#include "assets/atlas/unwrap_shapes.h"

#include "assets/atlas/charts.h"
#include "assets/base/numbering.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relume {

namespace {

// Entries of a shape's factor, about 1, that differ by less are the same: matrices of turned instances are
// exact to some 1e-7, and charts change their stretch by no more than this.
constexpr double kSameFactor = 1e-3;

uint64_t hashBytes(uint64_t hash, const void* data, size_t bytes) {
    const auto* from = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; i += sizeof(uint64_t)) {
        uint64_t word = 0;
        std::memcpy(&word, from + i, std::min(sizeof(word), bytes - i));
        hash = mixBits(hash ^ (word + 0x9e3779b97f4a7c15ull));
    }
    return mixBits(hash ^ bytes);
}

template<typename T>
uint64_t hashValues(uint64_t hash, const std::vector<T>& values) {
    return hashBytes(hash, values.data(), values.size() * sizeof(T));
}

uint64_t hashOf(const Mesh& mesh, int set) {
    uint64_t hash = static_cast<uint64_t>(set + 1);
    for (const Primitive& primitive : mesh.primitives) {
        hash = hashValues(hash, primitive.positions);
        hash = hashValues(hash, primitive.indices);
        if (set >= 0) hash = hashValues(hash, uvSet(primitive, set));
    }
    return hash;
}

/// Splits the linear part M of a transform into a size and an upper triangular factor R whose columns are as
/// long as those of M over the size, and at the same angles: R^T R = M^T M / size^2 [Cholesky]. Rotations and
/// mirrors are gone.
double splitTransform(const glm::dmat3& linear, glm::dmat3& factor) {
    glm::dmat3 gram = glm::transpose(linear) * linear;
    const double size = std::sqrt((gram[0][0] + gram[1][1] + gram[2][2]) / 3.0);
    factor = glm::dmat3(1.0);
    if (!(size > 0.0) || !std::isfinite(size)) return 0.0;
    gram /= size * size;
    glm::dmat3 r(0.0);
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row <= column; ++row) {
            double rest = gram[column][row];
            for (int k = 0; k < row; ++k)
                rest -= r[row][k] * r[column][k];
            if (row < column)
                r[column][row] = r[row][row] > 0.0 ? rest / r[row][row] : 0.0;
            else
                r[column][row] = std::sqrt(std::max(rest, 0.0));
        }
    }
    bool plain = true;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            plain = plain && std::abs(r[column][row] - factor[column][row]) < kSameFactor;
    if (!plain) factor = r;
    return size;
}

bool sameFactor(const glm::dmat3& a, const glm::dmat3& b) {
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (!(std::abs(a[column][row] - b[column][row]) < kSameFactor)) return false;
    return true;
}

bool sameTexel(double a, double b) {
    constexpr double kSameTexel = 2.5; // factor; texels are powers of two, so that neighbours are the same
    return a <= kSameTexel * b && b <= kSameTexel * a;
}

std::vector<glm::dvec3> cornersOf(const Mesh& mesh, const glm::dmat3& factor) {
    std::vector<glm::dvec3> corners;
    for (const Primitive& primitive : mesh.primitives)
        for (uint32_t index : primitive.indices)
            corners.push_back(factor * glm::dvec3(primitive.positions[index]));
    return corners;
}

/// Returns a mesh's own UVs as one chart as large as the surface.
PlanarChart keptChart(const Mesh& mesh, int set, const std::vector<glm::dvec3>& corners) {
    PlanarChart chart;
    for (const Primitive& primitive : mesh.primitives)
        for (uint32_t index : primitive.indices)
            chart.uv.push_back(glm::dvec2(uvSet(primitive, set)[index]));
    double area = 0.0, flat = 0.0;
    glm::dvec2 low(1e300), high(-1e300);
    for (size_t i = 0; i < chart.uv.size(); i += 3) {
        chart.triangles.push_back(static_cast<uint32_t>(i / 3));
        area += 0.5 * glm::length(glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]));
        const glm::dvec2 a = chart.uv[i + 1] - chart.uv[i], b = chart.uv[i + 2] - chart.uv[i];
        flat += 0.5 * std::abs(a.x * b.y - a.y * b.x);
        for (size_t k = 0; k < 3; ++k) {
            low = glm::min(low, chart.uv[i + k]);
            high = glm::max(high, chart.uv[i + k]);
        }
    }
    const double metres = flat > 0.0 && std::isfinite(area / flat) ? std::sqrt(area / flat) : 0.0;
    for (glm::dvec2& uv : chart.uv)
        uv = (uv - low) * metres;
    chart.extent = (high - low) * metres;
    return chart;
}

} // namespace

bool sameShape(const UnwrapShape& a, const UnwrapShape& b) {
    return a.hash == b.hash && a.kept == b.kept && sameTexel(a.texel, b.texel) &&
           sameFactor(a.factor, b.factor);
}

UnwrapParts collectParts(const Scene& scene, const std::vector<bool>& chosen, const std::vector<int>& set) {
    UnwrapParts parts;
    std::vector<uint64_t> hashes(scene.meshes.size());
    std::vector<std::vector<size_t>> shapesOf(scene.meshes.size());
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const auto mesh = static_cast<size_t>(instance.mesh);
        if (!chosen[mesh] && set[mesh] < 0) continue;
        std::vector<size_t>& own = shapesOf[mesh];
        if (own.empty()) hashes[mesh] = hashOf(scene.meshes[mesh], set[mesh]);
        UnwrapShape shape{hashes[mesh], glm::dmat3(1.0), 0.0, set[mesh] >= 0, false, {}};
        const double size = splitTransform(glm::dmat3(instance.transform), shape.factor);
        const auto found =
            std::find_if(own.begin(), own.end(), [&](size_t s) { return sameShape(parts.shapes[s], shape); });
        parts.objects.push_back({i, found == own.end() ? parts.shapes.size() : *found, size});
        if (found != own.end()) continue;
        own.push_back(parts.shapes.size());
        parts.shapes.push_back(std::move(shape));
        parts.meshOf.push_back(mesh);
    }
    return parts;
}

double areaOf(const Mesh& mesh, const UnwrapShape& shape) {
    const std::vector<glm::dvec3> corners = cornersOf(mesh, shape.factor);
    double area = 0.0;
    for (size_t i = 0; i + 2 < corners.size(); i += 3)
        area += 0.5 * glm::length(glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]));
    return area;
}

void cutShape(const Mesh& mesh, int set, UnwrapShape& shape, WorkerPool& pool) {
    const std::vector<glm::dvec3> corners = cornersOf(mesh, shape.factor);
    if (set >= 0)
        shape.charts = {keptChart(mesh, set, corners)};
    else
        shape.charts = cutCharts(corners, shape.texel, pool);
}

void cutShapeUp(const Mesh& mesh, UnwrapShape& shape) {
    shape.charts = cutSingleTriangles(cornersOf(mesh, shape.factor));
}

} // namespace relume
