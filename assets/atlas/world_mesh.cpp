#include "assets/atlas/world_mesh.h"

#include "assets/atlas/uv_charts.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/base/watch.h"
#include "assets/model/scene_limits.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <map>
#include <optional>

namespace relume {

namespace {

/// Holds one primitive of one instance on its way into the list.
struct Part {
    const Scene* scene;
    const Primitive* primitive;
    const LightmapAtlas* atlas;
    const std::vector<uint32_t>* charts; // nullptr: no lightmap UVs
    uint32_t chartBase, instance, material;
    glm::mat4 transform;
};

bool isMasked(const Scene& scene, int material) {
    return material >= 0 && scene.materials[static_cast<size_t>(material)].alphaMode == AlphaMode::Mask;
}

bool isPane(const Scene& scene, int material) {
    return material >= 0 && scene.materials[static_cast<size_t>(material)].pane;
}

/// Returns the instances that are not hidden.
std::vector<uint32_t> shownInstances(const Scene& scene) {
    std::vector<uint32_t> shown;
    for (uint32_t i = 0; i < scene.instances.size(); ++i)
        if (!scene.instances[i].hidden) shown.push_back(i);
    return shown;
}

/// Returns the cofactors of the linear part: the inverse transpose times the determinant, which also serves
/// singular ones.
glm::mat3 normalMatrix(const glm::mat4& transform) {
    const glm::dvec3 x(transform[0]), y(transform[1]), z(transform[2]);
    const glm::dmat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
    const double largest =
        std::max({glm::length(cofactors[0]), glm::length(cofactors[1]), glm::length(cofactors[2])});
    const double sign = glm::dot(x, cofactors[0]) < 0.0 ? -1.0 : 1.0;
    return glm::mat3(largest > 0.0 ? cofactors * (sign / largest) : cofactors);
}

/// Appends triangles to the corner arrays.
class Flattener {
public:
    explicit Flattener(WorldMesh& mesh) : mesh_(mesh) {}
    void reserve(size_t triangles);
    void add(const Part& part);
    size_t dropped() const { return dropped_; }
    /// Returns the number of triangles that reach beyond kFarthest, by mesh.
    const std::map<int, size_t>& far() const { return far_; }

private:
    void addUvs(const TextureRef* use, const Primitive& primitive, const uint32_t* corners,
                std::vector<glm::vec2>& out) const;
    void addCorners(const Part& part, const uint32_t* corners);
    void addNormals(const std::array<glm::vec3, 3>& positions, const uint32_t* corners);

    WorldMesh& mesh_;
    std::vector<glm::vec3> positions_, normals_; // of the part's vertices, world space
    size_t dropped_ = 0;
    std::map<int, size_t> far_;
};

void Flattener::reserve(size_t triangles) {
    mesh_.positions.reserve(3 * triangles);
    mesh_.normals.reserve(3 * triangles);
    mesh_.lightmapUv.reserve(3 * triangles);
    mesh_.baseUv.reserve(3 * triangles);
    mesh_.emissionUv.reserve(3 * triangles);
    mesh_.metallicUv.reserve(3 * triangles);
    mesh_.colors.reserve(3 * triangles);
    mesh_.material.reserve(triangles);
    mesh_.instance.reserve(triangles);
    mesh_.chart.reserve(triangles);
}

void Flattener::addUvs(const TextureRef* use, const Primitive& primitive, const uint32_t* corners,
                       std::vector<glm::vec2>& out) const {
    const std::vector<glm::vec2>* uvs = use ? &uvsOf(primitive, *use) : nullptr;
    for (int k = 0; k < 3; ++k)
        out.push_back(uvs && !uvs->empty() ? glm::vec2(use->transform * glm::vec3((*uvs)[corners[k]], 1.0f))
                                           : glm::vec2(0.0f));
}

void Flattener::addNormals(const std::array<glm::vec3, 3>& positions, const uint32_t* corners) {
    const glm::vec3 face = glm::cross(positions[1] - positions[0], positions[2] - positions[0]);
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& normal = normals_[corners[k]];
        const float square = glm::dot(normal, normal);
        mesh_.normals.push_back(square > FLT_MIN && std::isfinite(square) ? normal / std::sqrt(square)
                                                                          : glm::normalize(face));
    }
}

void Flattener::addCorners(const Part& part, const uint32_t* corners) {
    const Primitive& primitive = *part.primitive;
    const std::vector<glm::vec2>& uvs = uvSet(primitive, part.atlas->instances[part.instance].texCoord);
    for (int k = 0; k < 3; ++k) {
        mesh_.positions.push_back(positions_[corners[k]]);
        const glm::vec2 uv =
            part.charts ? part.atlas->sheetUv(part.instance, uvs[corners[k]]) : glm::vec2(0.0f);
        mesh_.lightmapUv.push_back(glm::clamp(uv, 0.0f, 1.0f));
        mesh_.colors.push_back(primitive.colors.empty() ? glm::vec4(1.0f) : primitive.colors[corners[k]]);
    }
    const std::vector<Material>& materials = part.scene->materials;
    const Material* material = part.material < materials.size() ? &materials[part.material] : nullptr;
    const auto used = [&](TextureRef Material::*ref) {
        return material && (material->*ref).texture >= 0 ? &(material->*ref) : nullptr;
    };
    addUvs(used(&Material::baseColorTexture), primitive, corners, mesh_.baseUv);
    addUvs(used(&Material::emissionTexture), primitive, corners, mesh_.emissionUv);
    addUvs(used(&Material::metallicRoughnessTexture), primitive, corners, mesh_.metallicUv);
}

void Flattener::add(const Part& part) {
    const Primitive& primitive = *part.primitive;
    const glm::mat3 toNormal = normalMatrix(part.transform);
    const bool mirrored = glm::determinant(glm::dmat3(part.transform)) < 0.0;
    positions_.resize(primitive.positions.size());
    normals_.resize(primitive.positions.size());
    for (size_t v = 0; v < positions_.size(); ++v) {
        positions_[v] = glm::vec3(part.transform * glm::vec4(primitive.positions[v], 1.0f));
        normals_[v] = primitive.normals.empty() ? glm::vec3(0.0f) : toNormal * primitive.normals[v];
    }
    constexpr unsigned kTriangles = 4096;
    WatchedLoop loop("triangles", static_cast<double>(primitive.indices.size() / 3), kTriangles);
    for (size_t i = 0; i < primitive.indices.size(); i += 3, loop.step()) {
        std::array<uint32_t, 3> corners = {primitive.indices[i], primitive.indices[i + 1],
                                           primitive.indices[i + 2]};
        if (mirrored) std::swap(corners[1], corners[2]);
        const std::array<glm::vec3, 3> p = {positions_[corners[0]], positions_[corners[1]],
                                            positions_[corners[2]]};
        if (!isWithinReach(p[0]) || !isWithinReach(p[1]) || !isWithinReach(p[2])) {
            ++far_[part.scene->instances[part.instance].mesh];
            continue;
        }
        const glm::vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
        const float square = glm::dot(face, face);
        // Normalizing is no longer exact below FLT_MIN.
        if (!(square > FLT_MIN) || !std::isfinite(square)) {
            ++dropped_;
            continue;
        }
        addCorners(part, corners.data());
        addNormals(p, corners.data());
        mesh_.material.push_back(part.material);
        mesh_.instance.push_back(part.instance);
        mesh_.chart.push_back(part.charts ? part.chartBase + (*part.charts)[i / 3] : kNoChart);
    }
}

/// Lists the parts of all instances in file order; charts of a mesh are found once for all its instances.
class PartList {
public:
    PartList(const Scene& scene, const LightmapAtlas& atlas, std::span<const uint32_t> instances)
        : charts_(scene.meshes.size()) {
        for (const uint32_t i : instances)
            addInstance(scene, atlas, i);
    }
    const std::vector<Part>& parts() const { return parts_; }
    uint32_t chartBound() const { return nextChart_; }
    size_t triangles() const { return triangles_; }

private:
    void addInstance(const Scene& scene, const LightmapAtlas& atlas, size_t index) {
        const Instance& instance = scene.instances[index];
        const AtlasRect& rect = atlas.instances[index];
        const size_t meshIndex = static_cast<size_t>(instance.mesh);
        const Mesh& mesh = scene.meshes[meshIndex];
        std::optional<UvCharts>& charts = charts_[meshIndex];
        if (rect.texCoord >= 0 && !charts) charts = findCharts(mesh, rect.texCoord);
        for (size_t k = 0; k < mesh.primitives.size(); ++k) {
            const Primitive& primitive = mesh.primitives[k];
            const bool mapped = rect.texCoord >= 0 && !charts->chart[k].empty();
            const uint32_t material = primitive.material >= 0 ? static_cast<uint32_t>(primitive.material)
                                                              : static_cast<uint32_t>(scene.materials.size());
            parts_.push_back({&scene, &primitive, &atlas, mapped ? &charts->chart[k] : nullptr, nextChart_,
                              static_cast<uint32_t>(index), material, instance.transform});
            triangles_ += primitive.indices.size() / 3;
        }
        if (rect.texCoord >= 0) nextChart_ += charts->count;
    }

    std::vector<std::optional<UvCharts>> charts_; // per mesh; all its instances take the same UV set
    std::vector<Part> parts_;
    uint32_t nextChart_ = 0;
    size_t triangles_ = 0;
};

void warnAboutDropped(const Scene& scene, const Flattener& flattener) {
    if (flattener.dropped() > 0)
        spdlog::warn("{}: {} triangles without area are dropped", scene.path, flattener.dropped());
    Warnings warnings;
    for (const auto& [mesh, count] : flattener.far())
        warnings.add("mesh " + inQuotes(scene.meshes[static_cast<size_t>(mesh)].name), farTriangles(count));
    for (const std::string& line : warnings.lines(scene.path))
        spdlog::warn("{}", line);
}

/// Numbers the charts that have triangles left from 0 on, in order of appearance.
void compactCharts(WorldMesh& mesh, uint32_t bound) {
    std::vector<uint32_t> number(bound, kNoChart);
    for (uint32_t& chart : mesh.chart) {
        if (chart == kNoChart) continue;
        if (number[chart] == kNoChart) number[chart] = mesh.chartCount++;
        chart = number[chart];
    }
}

} // namespace

WorldMesh flattenInstances(const Scene& scene, const LightmapAtlas& atlas,
                           std::span<const uint32_t> instances) {
    ASSERT(atlas.instances.size() == scene.instances.size());
    const PartList list(scene, atlas, instances);
    WorldMesh mesh;
    mesh.pages = atlas.pages;
    Flattener flattener(mesh);
    flattener.reserve(list.triangles());
    const auto addParts = [&](bool masked) {
        for (const Part& part : list.parts())
            if (const int material = part.primitive->material;
                isMasked(scene, material) == masked && !isPane(scene, material))
                flattener.add(part);
    };
    addParts(false);
    mesh.opaqueCount = mesh.triangleCount();
    addParts(true);
    warnAboutDropped(scene, flattener);
    compactCharts(mesh, list.chartBound());
    return mesh;
}

WorldMesh flatten(const Scene& scene, const LightmapAtlas& atlas) {
    WorldMesh mesh = flattenInstances(scene, atlas, shownInstances(scene));
    if (mesh.triangleCount() == 0)
        throw Error(scene.path + ": has no triangle with an area: export it with its geometry");
    return mesh;
}

WorldMesh flattenPanes(const Scene& scene) {
    WorldMesh mesh;
    if (std::none_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.pane; }))
        return mesh;
    LightmapAtlas unmapped;
    unmapped.instances.resize(scene.instances.size());
    const PartList list(scene, unmapped, shownInstances(scene));
    Flattener flattener(mesh);
    for (const Part& part : list.parts())
        if (isPane(scene, part.primitive->material)) flattener.add(part);
    mesh.opaqueCount = mesh.triangleCount();
    return mesh;
}

} // namespace relume
