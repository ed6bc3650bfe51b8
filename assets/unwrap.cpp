#include "assets/unwrap.h"

#include "assets/error.h"
#include "assets/lightmap_atlas.h"
#include "assets/numbering.h"
#include "assets/planar_charts.h"
#include "assets/rect_pack.h"
#include "assets/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace relume {

namespace {

constexpr uint32_t kGutter = 2;        // [texels], between charts
constexpr double kFill = 0.5;          // share of an atlas that charts of usual shapes end up covering
constexpr double kMaxTexels = 65536.0; // [texels] to a side of one mesh

/// UVs of a mesh's triangle corners, and which chart each triangle belongs to.
struct Layout {
    std::vector<glm::vec2> uv;   // 3 per triangle
    std::vector<uint32_t> chart; // per triangle, kNoNumber: no area
    uint32_t charts = 0;
};

double areaScale(const glm::dmat3& linear) {
    return std::pow(std::abs(glm::determinant(linear)), 2.0 / 3.0);
}

/// The linear part of the largest instance of each mesh: its charts are measured as that one stands in the
/// world.
std::vector<glm::dmat3> largestTransforms(const Scene& scene) {
    std::vector<glm::dmat3> transforms(scene.meshes.size(), glm::dmat3(0.0));
    for (const Instance& instance : scene.instances) {
        glm::dmat3& best = transforms[static_cast<size_t>(instance.mesh)];
        const glm::dmat3 linear(instance.transform);
        if (areaScale(linear) > areaScale(best)) best = linear;
    }
    for (glm::dmat3& transform : transforms)
        if (!(areaScale(transform) > 0.0) || !std::isfinite(areaScale(transform)))
            transform = glm::dmat3(1.0);
    return transforms;
}

std::vector<glm::dvec3> cornersOf(const Mesh& mesh, const glm::dmat3& transform) {
    std::vector<glm::dvec3> corners;
    for (const Primitive& primitive : mesh.primitives)
        for (uint32_t index : primitive.indices)
            corners.push_back(transform * glm::dvec3(primitive.positions[index]));
    return corners;
}

double areaOf(const std::vector<glm::dvec3>& corners) {
    double area = 0.0;
    for (size_t i = 0; i + 2 < corners.size(); i += 3)
        area += 0.5 * glm::length(glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]));
    return area;
}

double densityThatFills(const Scene& scene, uint32_t size) {
    double area = 0.0;
    for (const Instance& instance : scene.instances)
        area += areaOf(
            cornersOf(scene.meshes[static_cast<size_t>(instance.mesh)], glm::dmat3(instance.transform)));
    return area > 0.0 && std::isfinite(area) ? size * std::sqrt(kFill / area) : 1.0;
}

/// Gives each chart whole texels, packs them and scales to the unit square.
Layout layOut(const std::vector<PlanarChart>& charts, size_t triangles, double density,
              const std::string& name) {
    std::vector<PackedRect> rects(charts.size());
    double area = 0.0;
    uint32_t width = 1;
    for (size_t i = 0; i < charts.size(); ++i) {
        const glm::dvec2 texels = glm::max(glm::round(charts[i].extent * density), glm::dvec2(1.0));
        area += (texels.x + kGutter) * (texels.y + kGutter);
        if (!(std::max(texels.x, texels.y) <= kMaxTexels) || !(std::sqrt(area) <= kMaxTexels))
            throw Error(
                fmt::format("{} needs more than {} texels a side at {} texels/m: use a lower --density", name,
                            kMaxTexels, density));
        rects[i].width = static_cast<uint32_t>(texels.x);
        rects[i].height = static_cast<uint32_t>(texels.y);
        width = std::max(width, rects[i].width);
    }
    width = std::max(width, static_cast<uint32_t>(std::ceil(std::sqrt(area))));
    constexpr uint32_t kAnyHeight = 1u << 30;
    ASSERT(packRects(rects, width, kAnyHeight, kGutter));

    uint32_t side = 1;
    for (const PackedRect& rect : rects)
        side = std::max({side, rect.x + rect.width, rect.y + rect.height});
    Layout layout;
    layout.uv.resize(3 * triangles);
    layout.chart.assign(triangles, kNoNumber);
    layout.charts = static_cast<uint32_t>(charts.size());
    for (size_t i = 0; i < charts.size(); ++i) {
        // Stretched to fill its texels, so that straight borders run along texel edges.
        const glm::dvec2 corner(rects[i].x, rects[i].y), texels(rects[i].width, rects[i].height);
        const glm::dvec2 stretch = texels / glm::max(charts[i].extent, glm::dvec2(1e-300));
        for (size_t t = 0; t < charts[i].triangles.size(); ++t) {
            const uint32_t triangle = charts[i].triangles[t];
            layout.chart[triangle] = static_cast<uint32_t>(i);
            for (size_t k = 0; k < 3; ++k) {
                const glm::dvec2 uv =
                    (corner + glm::min(charts[i].uv[3 * t + k] * stretch, texels)) / double(side);
                layout.uv[3 * triangle + k] = glm::clamp(glm::vec2(uv), 0.0f, 1.0f);
            }
        }
    }
    return layout;
}

template<typename T>
void pick(std::vector<T>& values, const Numbering<uint64_t>& vertices) {
    if (values.empty()) return;
    std::vector<T> out(vertices.size());
    for (uint32_t i = 0; i < out.size(); ++i)
        out[i] = values[vertices.key(i) >> 32];
    values = std::move(out);
}

/// Writes the UVs of the triangles from `first` on; a vertex in several charts becomes several.
void applyLayout(const Layout& layout, size_t first, Primitive& primitive) {
    Numbering<uint64_t> vertices(primitive.indices.size());
    std::vector<glm::vec2> uvs;
    for (size_t i = 0; i < primitive.indices.size(); ++i) {
        const size_t triangle = first + i / 3;
        const uint64_t key = (uint64_t(primitive.indices[i]) << 32) | layout.chart[triangle];
        primitive.indices[i] = vertices(key, mixBits(key));
        if (primitive.indices[i] == uvs.size()) uvs.push_back(layout.uv[3 * triangle + i % 3]);
    }
    pick(primitive.positions, vertices);
    pick(primitive.normals, vertices);
    pick(primitive.texCoord0, vertices);
    pick(primitive.colors, vertices);
    primitive.texCoord1 = std::move(uvs);
}

void applyLayout(const Layout& layout, Mesh& mesh) {
    size_t first = 0;
    for (Primitive& primitive : mesh.primitives) {
        const size_t count = primitive.indices.size() / 3;
        applyLayout(layout, first, primitive);
        first += count;
    }
}

/// Frees TEXCOORD_1 of a mesh whose textures use it, by moving it to TEXCOORD_0 in copies of the materials.
class TexCoordMover {
public:
    explicit TexCoordMover(Scene& scene) : scene_(scene), copies_(scene.materials.size(), -1) {}
    void run(Mesh& mesh) {
        for (Primitive& primitive : mesh.primitives)
            if (primitive.material >= 0) run(mesh, primitive);
    }

private:
    static constexpr TextureRef Material::*kUses[] = {&Material::baseColorTexture, &Material::emissionTexture,
                                                      &Material::metallicRoughnessTexture};
    void run(const Mesh& mesh, Primitive& primitive) {
        const Material material = scene_.materials[static_cast<size_t>(primitive.material)];
        bool usesSet[2] = {false, false};
        for (TextureRef Material::*use : kUses)
            if ((material.*use).texture >= 0) usesSet[(material.*use).texCoord] = true;
        if (!usesSet[1]) return;
        if (usesSet[0])
            throw Error(fmt::format(
                "{}: mesh {} needs both its UV sets for textures, so none is free for the lightmap: "
                "let its textures share one set",
                scene_.path, quoted(mesh.name)));
        if (copies_[static_cast<size_t>(primitive.material)] < 0) {
            copies_[static_cast<size_t>(primitive.material)] = static_cast<int>(scene_.materials.size());
            scene_.materials.push_back(material);
            for (TextureRef Material::*use : kUses)
                (scene_.materials.back().*use).texCoord = 0;
        }
        primitive.material = copies_[static_cast<size_t>(primitive.material)];
        primitive.texCoord0 = primitive.texCoord1;
    }

    Scene& scene_;
    std::vector<int> copies_; // of the scene's own materials, -1: none yet
};

void unwrapMesh(Mesh& mesh, const glm::dmat3& transform, double density, UnwrapResult& result) {
    const std::string name = "mesh " + quoted(mesh.name);
    const std::vector<glm::dvec3> corners = cornersOf(mesh, transform);
    const std::vector<PlanarChart> charts = cutPlanarCharts(corners);
    if (charts.empty()) return; // nothing but triangles without area
    const Mesh original = mesh;
    Layout layout = layOut(charts, corners.size() / 3, density, name);
    applyLayout(layout, mesh);
    if (lightmapSet(mesh) != 1) {
        // Overlap finer than the grid that looks for it adds up in no known mesh; single triangles cannot
        // overlap.
        mesh = original;
        layout = layOut(cutSingleTriangles(corners), corners.size() / 3, density, name);
        applyLayout(layout, mesh);
    }
    ++result.meshes;
    result.charts += layout.charts;
}

} // namespace

UnwrapResult unwrap(Scene& scene, const UnwrapDesc& desc) {
    UnwrapResult result;
    result.density = desc.density > 0.0 ? desc.density : densityThatFills(scene, desc.size);
    const std::vector<glm::dmat3> transforms = largestTransforms(scene);
    TexCoordMover mover(scene);
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
        Mesh& mesh = scene.meshes[i];
        if (mesh.primitives.empty() || (desc.onlyMissing && lightmapSet(mesh) >= 0)) continue;
        mover.run(mesh);
        unwrapMesh(mesh, transforms[i], result.density, result);
    }
    return result;
}

} // namespace relume
