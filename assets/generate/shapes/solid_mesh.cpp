#include "assets/generate/shapes/solid_mesh.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace relume::generate {
namespace {

// Surfaces that bend by more than 38 degrees between neighbouring triangles have an edge there: rounds of 12
// segments and more look round, hexagons and boxes keep their edges.
constexpr double kCreaseCosine = 0.788;

using Corner = std::tuple<double, double, double>;

Corner cornerOf(const glm::dvec3& p) {
    return {p.x, p.y, p.z};
}

// A face is a triangle of a solid with snapped corners; degenerate ones are left out.
struct Face {
    size_t chart;
    uint32_t vertex[3];
    int corner[3]; // welded positions over all charts
    glm::dvec3 areaNormal;
    glm::dvec3 normal;
};

std::vector<Face> facesOf(const Solid& solid) {
    std::map<Corner, int> corners;
    std::vector<Face> faces;
    for (size_t c = 0; c < solid.charts.size(); ++c) {
        const Chart& chart = solid.charts[c];
        for (size_t i = 0; i + 2 < chart.indices.size(); i += 3) {
            Face face{};
            face.chart = c;
            glm::dvec3 p[3];
            for (int k = 0; k < 3; ++k) {
                face.vertex[k] = chart.indices[i + k];
                p[k] = snap(chart.vertices[face.vertex[k]].position);
                face.corner[k] =
                    corners.try_emplace(cornerOf(p[k]), static_cast<int>(corners.size())).first->second;
            }
            face.areaNormal = glm::cross(p[1] - p[0], p[2] - p[0]);
            const double length = glm::length(face.areaNormal);
            if (length == 0.0) continue;
            face.normal = face.areaNormal / length;
            faces.push_back(face);
        }
    }
    return faces;
}

// Returns the shading normal of each face's corners: the area-weighted mean of the faces around the corner on
// this side of a crease.
std::vector<glm::vec3> cornerNormals(const std::vector<Face>& faces) {
    std::map<int, std::vector<int>> around;
    for (size_t f = 0; f < faces.size(); ++f)
        for (int corner : faces[f].corner)
            around[corner].push_back(static_cast<int>(f));
    std::vector<glm::vec3> normals;
    normals.reserve(faces.size() * 3);
    for (const Face& face : faces)
        for (int corner : face.corner) {
            glm::dvec3 sum(0.0);
            for (int other : around[corner])
                if (glm::dot(faces[other].normal, face.normal) > kCreaseCosine)
                    sum += faces[other].areaNormal;
            normals.emplace_back(sum / glm::length(sum));
        }
    return normals;
}

glm::vec2 steadyTexCoord(const glm::dvec2& texCoord, const glm::dvec2& tile) {
    return glm::vec2(glm::dvec2(snap(glm::dvec3(texCoord / tile, 0.0))));
}

} // namespace

Mesh meshOf(const std::string& name, const Solid& solid, const std::vector<glm::dvec2>& tiles,
            LightmapUvs uvs) {
    const std::vector<Face> faces = facesOf(solid);
    const std::vector<glm::vec3> normals = cornerNormals(faces);
    Mesh mesh;
    mesh.name = name;
    using Key = std::tuple<size_t, uint32_t, float, float, float>;
    std::map<Key, uint32_t> known;
    for (size_t f = 0; f < faces.size(); ++f) {
        const Chart& chart = solid.charts[faces[f].chart];
        auto primitive = std::find_if(mesh.primitives.begin(), mesh.primitives.end(),
                                      [&](const Primitive& p) { return p.material == chart.material; });
        if (primitive == mesh.primitives.end()) {
            primitive = mesh.primitives.emplace(mesh.primitives.end());
            primitive->material = chart.material;
        }
        for (int k = 0; k < 3; ++k) {
            const uint32_t index = faces[f].vertex[k];
            const glm::vec3& n = normals[3 * f + k];
            const auto fresh = static_cast<uint32_t>(primitive->positions.size());
            const auto [entry, inserted] = known.try_emplace({faces[f].chart, index, n.x, n.y, n.z}, fresh);
            primitive->indices.push_back(entry->second);
            if (!inserted) continue;
            const ChartVertex& vertex = chart.vertices[index];
            primitive->positions.emplace_back(snap(vertex.position));
            primitive->normals.push_back(n);
            if (uvs == LightmapUvs::Places) primitive->texCoord1.emplace_back(vertex.place);
            const glm::dvec2& tile = tiles[chart.material];
            if (tile.x > 0.0) primitive->texCoord0.push_back(steadyTexCoord(vertex.texCoord, tile));
        }
    }
    return mesh;
}

} // namespace relume::generate
