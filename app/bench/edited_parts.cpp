#include "app/bench/edited_parts.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace relume {

std::optional<uint32_t> largestMaterial(const WorldMesh& mesh, const Scene& scene) {
    std::vector<double> areas(scene.materials.size() + 1, 0.0);
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t) {
        const glm::vec3* p = &mesh.positions[size_t{t} * 3];
        areas[mesh.material[t]] += glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
    }
    std::optional<uint32_t> most;
    for (uint32_t m = 0; m < scene.materials.size(); ++m) {
        const glm::vec4& colour = scene.materials[m].baseColor;
        if (std::max({colour.r, colour.g, colour.b}) <= 0.0f || areas[m] <= 0.0) continue;
        if (!most || areas[m] > areas[*most]) most = m;
    }
    return most;
}

std::optional<std::pair<uint32_t, double>> smallObject(const WorldMesh& mesh, const Scene& scene) {
    constexpr double kWanted = 0.01, kMost = 0.5;
    std::vector<double> triangles(scene.instances.size(), 0.0);
    for (const uint32_t instance : mesh.instance)
        triangles[instance] += 1.0 / mesh.triangleCount();
    const auto off = [&](uint32_t i) { return std::abs(std::log(triangles[i] / kWanted)); };
    std::optional<uint32_t> best;
    for (uint32_t i = 0; i < triangles.size(); ++i)
        if (triangles[i] > 0.0 && triangles[i] < kMost && (!best || off(i) < off(*best))) best = i;
    if (!best) return {};
    return std::pair(*best, triangles[*best]);
}

} // namespace relume
