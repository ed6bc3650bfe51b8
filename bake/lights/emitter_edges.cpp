#include "bake/lights/emitter_edges.h"

#include <array>
#include <map>
#include <tuple>
#include <utility>

namespace relume {
namespace {

using shader::EmitterEdge;
using shader::EmitterPolygon;

struct Plane {
    glm::vec3 normal; // unit, zero of a polygon without area
    float height;     // along the normal [m]
};

Plane planeOf(const EmitterPolygon& e) {
    const glm::dvec3 front =
        glm::cross(glm::dvec3(e.c2) - glm::dvec3(e.c0), glm::dvec3(e.c3) - glm::dvec3(e.c1));
    const double size = glm::length(front);
    const glm::dvec3 normal = size > 0.0 ? front / size : glm::dvec3(0.0);
    const glm::dvec3 centre =
        0.25 * (glm::dvec3(e.c0) + glm::dvec3(e.c1) + glm::dvec3(e.c2) + glm::dvec3(e.c3));
    return {glm::vec3(normal), static_cast<float>(glm::dot(normal, centre))};
}

using Corner = std::tuple<float, float, float>;
Corner cornerOf(const glm::vec3& p) {
    return {p.x, p.y, p.z};
}

} // namespace

std::vector<EmitterEdge> emitterEdges(std::span<const EmitterPolygon> polygons) {
    std::vector<EmitterEdge> edges;
    std::map<std::pair<Corner, Corner>, size_t> open; // edges without a neighbour so far
    for (uint32_t i = 0; i < polygons.size(); ++i) {
        const EmitterPolygon& e = polygons[i];
        const Plane plane = planeOf(e);
        const std::array<glm::vec3, 4> corners{e.c0, e.c1, e.c2, e.c3};
        for (size_t k = 0; k < corners.size(); ++k) {
            const glm::vec3 from = corners[k], to = corners[(k + 1) % corners.size()];
            if (from == to) continue;
            const auto other = open.find({cornerOf(to), cornerOf(from)});
            if (other != open.end()) {
                EmitterEdge& edge = edges[other->second];
                edge.normalBeyond = plane.normal, edge.heightBeyond = plane.height, edge.polygonBeyond = i;
                open.erase(other);
                continue;
            }
            open.insert_or_assign({cornerOf(from), cornerOf(to)}, edges.size());
            edges.push_back({.from = from,
                             .height = plane.height,
                             .along = to - from,
                             .heightBeyond = 0.0f,
                             .normal = plane.normal,
                             .polygon = i,
                             .normalBeyond = glm::vec3(0.0f),
                             .polygonBeyond = i});
        }
    }
    return edges;
}

} // namespace relume
