#include "assets/atlas/world_mesh.h"

#include "assets/atlas/uv_charts.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/base/worker_pool.h"
#include "assets/model/scene_limits.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <functional>
#include <map>

namespace relume {

namespace {

/// Triangles that a thread lists at a time.
constexpr size_t kPortion = 4096;

/// Returns how many threads these instances' triangles are worth.
uint32_t threadsFor(const Scene& scene, std::span<const uint32_t> instances) {
    constexpr size_t kOfThread = size_t{1} << 15; // triangles: fewer take no longer than a thread's start
    size_t triangles = 0;
    for (const uint32_t i : instances)
        for (const Primitive& primitive :
             scene.meshes[static_cast<size_t>(scene.instances[i].mesh)].primitives)
            triangles += primitive.indices.size() / 3;
    return static_cast<uint32_t>(std::min<size_t>(WorkerPool::defaultSize(), 1 + triangles / kOfThread));
}

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

/// Tells where a texture finds its coordinates.
class TextureUvs {
public:
    /// None where the material has no such texture, or the primitive no such coordinates.
    TextureUvs(const Part& part, TextureRef Material::*ref) {
        const std::vector<Material>& materials = part.scene->materials;
        if (part.material >= materials.size()) return;
        use_ = &(materials[part.material].*ref);
        if (use_->texture >= 0) uvs_ = &uvsOf(*part.primitive, *use_);
    }
    glm::vec2 at(uint32_t vertex) const {
        return uvs_ && !uvs_->empty() ? glm::vec2(use_->transform * glm::vec3((*uvs_)[vertex], 1.0f))
                                      : glm::vec2(0.0f);
    }

private:
    const TextureRef* use_ = nullptr;
    const std::vector<glm::vec2>* uvs_ = nullptr;
};

using Corners = std::array<uint32_t, 3>; // vertices of a primitive
using Places = std::array<glm::vec3, 3>; // [m], in the world

/// Reads the triangles of one part in the world.
class PartReader {
public:
    explicit PartReader(const Part& part)
        : part_(part), toNormal_(normalMatrix(part.transform)),
          mirrored_(glm::determinant(glm::dmat3(part.transform)) < 0.0),
          lightmapUvs_(uvSet(*part.primitive, part.atlas->instances[part.instance].texCoord)),
          base_(part, &Material::baseColorTexture), emission_(part, &Material::emissionTexture),
          metallic_(part, &Material::metallicRoughnessTexture) {}

    Corners corners(size_t triangle) const {
        const uint32_t* first = &part_.primitive->indices[3 * triangle];
        return mirrored_ ? Corners{first[0], first[2], first[1]} : Corners{first[0], first[1], first[2]};
    }
    Places places(const Corners& corners) const {
        return {placeOf(corners[0]), placeOf(corners[1]), placeOf(corners[2])};
    }
    /// Writes a triangle to this place of the list.
    void write(WorldMesh& mesh, size_t place, size_t triangle) const;

private:
    glm::vec3 placeOf(uint32_t vertex) const {
        return glm::vec3(part_.transform * glm::vec4(part_.primitive->positions[vertex], 1.0f));
    }
    glm::vec3 normalOf(uint32_t vertex, const glm::vec3& face) const;

    const Part& part_;
    const glm::mat3 toNormal_;
    const bool mirrored_;
    const std::vector<glm::vec2>& lightmapUvs_;
    const TextureUvs base_, emission_, metallic_;
};

glm::vec3 PartReader::normalOf(uint32_t vertex, const glm::vec3& face) const {
    const std::vector<glm::vec3>& normals = part_.primitive->normals;
    const glm::vec3 normal = normals.empty() ? glm::vec3(0.0f) : toNormal_ * normals[vertex];
    const float square = glm::dot(normal, normal);
    return square > FLT_MIN && std::isfinite(square) ? normal / std::sqrt(square) : glm::normalize(face);
}

void PartReader::write(WorldMesh& mesh, size_t place, size_t triangle) const {
    const Corners vertices = corners(triangle);
    const Places p = places(vertices);
    const glm::vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t vertex = vertices[k];
        const size_t corner = 3 * place + k;
        const glm::vec2 uv =
            part_.charts ? part_.atlas->sheetUv(part_.instance, lightmapUvs_[vertex]) : glm::vec2(0.0f);
        mesh.positions[corner] = p[k];
        mesh.normals[corner] = normalOf(vertex, face);
        mesh.lightmapUv[corner] = glm::clamp(uv, 0.0f, 1.0f);
        mesh.baseUv[corner] = base_.at(vertex);
        mesh.emissionUv[corner] = emission_.at(vertex);
        mesh.metallicUv[corner] = metallic_.at(vertex);
        mesh.colors[corner] =
            part_.primitive->colors.empty() ? glm::vec4(1.0f) : part_.primitive->colors[vertex];
    }
    mesh.material[place] = part_.material;
    mesh.instance[place] = part_.instance;
    mesh.chart[place] = part_.charts ? part_.chartBase + (*part_.charts)[triangle] : kNoChart;
}

/// Tells whether a triangle is listed, or why it is not.
enum class Fate { Listed, WithoutArea, Far };

Fate fateOf(const Places& p) {
    if (!isWithinReach(p[0]) || !isWithinReach(p[1]) || !isWithinReach(p[2])) return Fate::Far;
    const glm::vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
    const float square = glm::dot(face, face);
    // Normalizing is no longer exact below FLT_MIN.
    return square > FLT_MIN && std::isfinite(square) ? Fate::Listed : Fate::WithoutArea;
}

/// Lists the triangles of parts, which all threads of a pool share: they are counted first, so that each
/// portion knows its place.
class Flattener {
public:
    explicit Flattener(WorldMesh& mesh) : mesh_(mesh) {}
    /// Adds a part behind those that were added before.
    void add(const Part& part);
    size_t partCount() const { return parts_.size(); }
    /// Lists what was added; returns how many triangles of the first `parts` parts are.
    uint32_t list(size_t parts, WorkerPool& pool);

    size_t dropped() const { return dropped_; }
    /// Returns the number of triangles that reach beyond kFarthest, by mesh.
    const std::map<int, size_t>& far() const { return far_; }

private:
    /// Some triangles of one part.
    struct Portion {
        size_t part, first, last;
        size_t place = 0; // of its first triangle in the list
        size_t listed = 0, dropped = 0, far = 0;
    };
    void count(Portion& portion) const;
    void write(const Portion& portion) const;
    void resize(size_t triangles, WorkerPool& pool);

    WorldMesh& mesh_;
    std::vector<Part> parts_;
    std::vector<Portion> portions_;
    size_t dropped_ = 0;
    std::map<int, size_t> far_;
};

void Flattener::add(const Part& part) {
    const size_t count = part.primitive->indices.size() / 3;
    for (size_t first = 0; first < count; first += kPortion)
        portions_.push_back({parts_.size(), first, std::min(count, first + kPortion)});
    parts_.push_back(part);
}

void Flattener::count(Portion& portion) const {
    const PartReader reader(parts_[portion.part]);
    for (size_t i = portion.first; i < portion.last; ++i) {
        const Fate fate = fateOf(reader.places(reader.corners(i)));
        portion.listed += fate == Fate::Listed;
        portion.dropped += fate == Fate::WithoutArea;
        portion.far += fate == Fate::Far;
    }
}

void Flattener::write(const Portion& portion) const {
    const PartReader reader(parts_[portion.part]);
    size_t place = portion.place;
    for (size_t i = portion.first; i < portion.last; ++i)
        if (portion.listed == portion.last - portion.first ||
            fateOf(reader.places(reader.corners(i))) == Fate::Listed)
            reader.write(mesh_, place++, i);
}

// Memory that nobody has written to yet is slow to get, so each array has a thread.
void Flattener::resize(size_t triangles, WorkerPool& pool) {
    const std::array<std::function<void()>, 10> arrays = {
        [&] { mesh_.positions.resize(3 * triangles); },  [&] { mesh_.normals.resize(3 * triangles); },
        [&] { mesh_.lightmapUv.resize(3 * triangles); }, [&] { mesh_.baseUv.resize(3 * triangles); },
        [&] { mesh_.emissionUv.resize(3 * triangles); }, [&] { mesh_.metallicUv.resize(3 * triangles); },
        [&] { mesh_.colors.resize(3 * triangles); },     [&] { mesh_.material.resize(triangles); },
        [&] { mesh_.instance.resize(triangles); },       [&] { mesh_.chart.resize(triangles); }};
    pool.run(arrays.size(), [&](uint32_t i) { arrays[i](); });
}

uint32_t Flattener::list(size_t parts, WorkerPool& pool) {
    const auto portions = static_cast<uint32_t>(portions_.size());
    runWatched(&pool, "triangles", portions, [&](uint32_t i) { count(portions_[i]); });
    size_t listed = 0, ofFirst = 0;
    for (Portion& portion : portions_) {
        portion.place = listed;
        listed += portion.listed;
        if (portion.part < parts) ofFirst = listed;
        dropped_ += portion.dropped;
        const Part& part = parts_[portion.part];
        if (portion.far > 0) far_[part.scene->instances[part.instance].mesh] += portion.far;
    }
    resize(listed, pool);
    runWatched(&pool, "triangles", portions, [&](uint32_t i) { write(portions_[i]); });
    return static_cast<uint32_t>(ofFirst);
}

/// Finds the charts of the meshes that these instances have lightmap UVs of, by mesh; all instances of a mesh
/// take the same UV set.
std::vector<UvCharts> chartsOf(const Scene& scene, const LightmapAtlas& atlas,
                               std::span<const uint32_t> instances, WorkerPool& pool) {
    std::vector<int> set(scene.meshes.size(), -1);
    for (const uint32_t i : instances)
        if (atlas.instances[i].texCoord >= 0)
            set[static_cast<size_t>(scene.instances[i].mesh)] = atlas.instances[i].texCoord;
    std::vector<UvCharts> charts(set.size());
    runWatched(&pool, "triangles", static_cast<uint32_t>(set.size()), [&](uint32_t i) {
        if (set[i] >= 0) charts[i] = findCharts(scene.meshes[i], set[i]);
    });
    return charts;
}

/// Lists the parts of instances in file order.
class PartList {
public:
    PartList(const Scene& scene, const LightmapAtlas& atlas, std::span<const uint32_t> instances,
             WorkerPool& pool)
        : charts_(chartsOf(scene, atlas, instances, pool)) {
        for (const uint32_t i : instances)
            addInstance(scene, atlas, i);
    }
    const std::vector<Part>& parts() const { return parts_; }
    uint32_t chartBound() const { return nextChart_; }

private:
    void addInstance(const Scene& scene, const LightmapAtlas& atlas, size_t index) {
        const Instance& instance = scene.instances[index];
        const bool hasUvs = atlas.instances[index].texCoord >= 0;
        const auto mesh = static_cast<size_t>(instance.mesh);
        const std::vector<Primitive>& primitives = scene.meshes[mesh].primitives;
        for (size_t k = 0; k < primitives.size(); ++k) {
            const Primitive& primitive = primitives[k];
            const bool mapped = hasUvs && !charts_[mesh].chart[k].empty();
            const uint32_t material = primitive.material >= 0 ? static_cast<uint32_t>(primitive.material)
                                                              : static_cast<uint32_t>(scene.materials.size());
            parts_.push_back({&scene, &primitive, &atlas, mapped ? &charts_[mesh].chart[k] : nullptr,
                              nextChart_, static_cast<uint32_t>(index), material, instance.transform});
        }
        if (hasUvs) nextChart_ += charts_[mesh].count;
    }

    std::vector<UvCharts> charts_; // per mesh
    std::vector<Part> parts_;
    uint32_t nextChart_ = 0;
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
    WorkerPool pool(threadsFor(scene, instances));
    const PartList list(scene, atlas, instances, pool);
    WorldMesh mesh;
    mesh.pages = atlas.pages;
    Flattener flattener(mesh);
    const auto addParts = [&](bool masked) {
        for (const Part& part : list.parts())
            if (const int material = part.primitive->material;
                isMasked(scene, material) == masked && !isPane(scene, material))
                flattener.add(part);
    };
    addParts(false);
    const size_t opaqueParts = flattener.partCount();
    addParts(true);
    mesh.opaqueCount = flattener.list(opaqueParts, pool);
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
    const std::vector<uint32_t> instances = shownInstances(scene);
    WorkerPool pool(threadsFor(scene, instances));
    const PartList list(scene, unmapped, instances, pool);
    Flattener flattener(mesh);
    for (const Part& part : list.parts())
        if (isPane(scene, part.primitive->material)) flattener.add(part);
    mesh.opaqueCount = flattener.list(flattener.partCount(), pool);
    return mesh;
}

} // namespace relume
