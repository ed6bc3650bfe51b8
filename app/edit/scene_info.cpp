#include "app/edit/scene_info.h"

#include "assets/atlas/world_mesh.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <set>

namespace relume {

namespace {

// Counts the triangles that are to be baked: those of panes and of hidden objects are left out.
uint32_t trianglesOf(const Scene& scene) {
    const auto isPane = [&](const Primitive& primitive) {
        return primitive.material >= 0 && scene.materials[static_cast<size_t>(primitive.material)].pane;
    };
    size_t count = 0;
    for (const Instance& instance : scene.instances) {
        if (instance.hidden) continue;
        for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
            if (!isPane(primitive)) count += primitive.indices.size() / 3;
    }
    return static_cast<uint32_t>(count);
}

void measureSurfaces(const Scene& scene, const WorldMesh& mesh, SceneInfo& info) {
    info.low = glm::vec3(std::numeric_limits<float>::max());
    info.high = -info.low;
    std::set<std::pair<uint32_t, uint32_t>> emitters; // instance and material
    for (uint32_t i = 0; i < mesh.triangleCount(); ++i) {
        const glm::vec3* p = &mesh.positions[3 * size_t(i)];
        for (int k = 0; k < 3; ++k) {
            info.low = glm::min(info.low, p[k]);
            info.high = glm::max(info.high, p[k]);
        }
        const glm::dvec3 a(p[0]);
        const double area = 0.5 * glm::length(glm::cross(glm::dvec3(p[1]) - a, glm::dvec3(p[2]) - a));
        info.area += area;
        if (mesh.material[i] >= scene.materials.size()) continue;
        const Material& material = scene.materials[mesh.material[i]];
        if (material.emission == glm::vec3(0.0f)) continue;
        emitters.insert({mesh.instance[i], mesh.material[i]});
        info.emitterArea += area;
        info.emitted += (material.doubleSided ? 2.0 : 1.0) * area * glm::dvec3(material.emission);
        info.texturedEmitters |= material.emissionTexture.texture >= 0;
    }
    info.emitters = static_cast<uint32_t>(emitters.size());
}

void addWarnings(const Scene& scene, const WorldMesh& mesh, SceneInfo& info) {
    Warnings warnings;
    std::vector<bool> used(scene.materials.size());
    for (uint32_t material : mesh.material)
        if (material < used.size()) used[material] = true;
    for (size_t i = 0; i < used.size(); ++i)
        if (used[i] && scene.materials[i].doubleSided)
            warnings.add(scene.materials[i].name.empty() ? fmt::format("material {}", i)
                                                         : "material " + inQuotes(scene.materials[i].name),
                         "double sided, the back shows the light of the front");
    if (info.droppedTriangles > 0)
        warnings.add(fmt::format("{} triangles", info.droppedTriangles), "have no area and are dropped");
    if (info.emitters == 0 && scene.lights.empty() && !scene.sky.shines())
        warnings.add("the scene",
                     "has no emitter, no light and no sky: it is lit by a preview light, which is "
                     "not in the file (--no-daylight: it bakes to black)");
    for (std::string& line : warnings.lines(scene.path))
        info.warnings.push_back(std::move(line));
}

} // namespace

SceneInfo inspectScene(const Scene& scene, uint32_t size) {
    SceneInfo info;
    info.warnings = scene.warnings;
    try {
        info.atlas = buildAtlas(scene, size);
        info.mapped = true;
        info.warnings.insert(info.warnings.end(), info.atlas.warnings.begin(), info.atlas.warnings.end());
    } catch (const Error& error) {
        info.warnings.push_back(error.what());
        info.atlas.instances.assign(scene.instances.size(), AtlasRect{});
    }
    const WorldMesh mesh = flatten(scene, info.atlas);
    if (info.mapped) info.statistics = measureAtlas(scene, info.atlas, size);
    info.charts = mesh.chartCount;
    info.triangles = mesh.triangleCount();
    info.maskedTriangles = mesh.triangleCount() - mesh.opaqueCount;
    info.droppedTriangles = trianglesOf(scene) - mesh.triangleCount();
    measureSurfaces(scene, mesh, info);
    addWarnings(scene, mesh, info);
    return info;
}

} // namespace relume
