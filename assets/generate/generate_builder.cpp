#include "assets/generate/generate_builder.h"

#include "assets/atlas/rect_pack.h"
#include "assets/base/error.h"

#include <algorithm>
#include <cmath>
#include <functional>
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

uint32_t cellsOf(double metres, double density) {
    return static_cast<uint32_t>(std::clamp(roundSteadily(metres * density), 1.0, double{kAtlasCells}));
}

enum class Orientation { AsIs, Wide, Tall };

bool isTurned(const Chart& chart, Orientation orientation) {
    if (orientation == Orientation::AsIs) return false;
    return orientation == Orientation::Wide ? chart.size.y > chart.size.x : chart.size.x > chart.size.y;
}

// Packs whole cells. Rectangles of one size get their places in their own order: the packer sorts with qsort,
// which leaves the order of equals to the C library.
bool packCells(std::vector<PackedRect>& rects) {
    if (!packRects(rects, kAtlasCells, kAtlasCells, 1)) return false;
    using Place = std::pair<uint32_t, uint32_t>;
    std::map<Place, std::vector<Place>> places; // by size
    for (const PackedRect& rect : rects)
        places[{rect.width, rect.height}].push_back({rect.y, rect.x});
    for (auto& [size, list] : places)
        std::sort(list.begin(), list.end(), std::greater<>());
    for (PackedRect& rect : rects) {
        std::vector<Place>& list = places[{rect.width, rect.height}];
        std::tie(rect.y, rect.x) = list.back();
        list.pop_back();
    }
    return true;
}

/// Returns a transform that stands at `eye`, with -Z towards `target` and X horizontal.
glm::mat4 lookingAt(const glm::vec3& eye, const glm::vec3& target) {
    const glm::vec3 back = glm::normalize(eye - target);
    const bool isVertical = back.x == 0.0f && back.z == 0.0f;
    const glm::vec3 up = isVertical ? glm::vec3(0, 0, -back.y) : glm::vec3(0, 1, 0);
    const glm::vec3 right = glm::normalize(glm::cross(up, back));
    return glm::mat4(glm::vec4(right, 0), glm::vec4(glm::cross(back, right), 0), glm::vec4(back, 0),
                     glm::vec4(eye, 1));
}

} // namespace

int SceneBuilder::paint(const std::string& name, const glm::vec3& color) {
    Material material;
    material.name = name;
    material.baseColor = glm::vec4(color, 1.0f);
    material.metallic = 0.0f;
    scene_.materials.push_back(material);
    tiles_.emplace_back(0.0);
    return static_cast<int>(scene_.materials.size()) - 1;
}

int SceneBuilder::lamp(const std::string& name, const glm::vec3& emission) {
    const int material = paint(name, glm::vec3(0.6f));
    scene_.materials.back().emission = emission;
    return material;
}

int SceneBuilder::textured(const std::string& name, Image image, const glm::dvec2& tile) {
    const int material = paint(name, glm::vec3(1.0f));
    scene_.materials.back().baseColorTexture.texture = static_cast<int>(scene_.textures.size());
    scene_.textures.push_back({static_cast<int>(scene_.images.size()), Wrap::Repeat, Wrap::Repeat, false});
    scene_.images.push_back(std::move(image));
    tiles_.back() = tile;
    return material;
}

void SceneBuilder::add(const std::string& name, Solid solid, const glm::dvec3& position) {
    parts_.push_back({name, std::move(solid), snap(position)});
}

void SceneBuilder::camera(const std::string& name, const glm::vec3& eye, const glm::vec3& target,
                          float yfovDegrees) {
    Camera camera;
    camera.name = name;
    camera.transform = lookingAt(eye, target);
    camera.yfov = glm::radians(yfovDegrees);
    camera.znear = 0.02f;
    scene_.cameras.push_back(camera);
}

void SceneBuilder::light(Light light, const glm::vec3& position, const glm::vec3& target) {
    light.transform = lookingAt(position, target);
    scene_.lights.push_back(std::move(light));
}

void SceneBuilder::sky(const glm::vec3& radiance) {
    scene_.sky.radiance = radiance;
}

// Finds the highest density at which all charts fit and turns their places into atlas coordinates.
void SceneBuilder::layOut() {
    std::vector<Chart*> charts;
    double area = 0.0;
    for (Part& part : parts_)
        for (Chart& chart : part.solid.charts) {
            charts.push_back(&chart);
            area += chart.size.x * chart.size.y * chart.density * chart.density;
        }
    ASSERT(!charts.empty());

    std::vector<PackedRect> rects(charts.size());
    // Steps of 0.3 % are below one cell for the largest chart.
    for (double density = kAtlasCells / std::sqrt(area);; density *= 0.997) {
        ASSERT(density * std::sqrt(area) > 1.0); // otherwise there are more charts than cells
        bool fits = false;
        for (Orientation orientation : {Orientation::AsIs, Orientation::Wide, Orientation::Tall}) {
            for (size_t i = 0; i < charts.size(); ++i) {
                const Chart& chart = *charts[i];
                rects[i].width = cellsOf(chart.size.x, density * chart.density);
                rects[i].height = cellsOf(chart.size.y, density * chart.density);
                if (isTurned(chart, orientation)) std::swap(rects[i].width, rects[i].height);
            }
            fits = packCells(rects);
            if (!fits) continue;
            for (size_t i = 0; i < charts.size(); ++i) {
                const PackedRect& rect = rects[i];
                const bool turned = isTurned(*charts[i], orientation);
                for (ChartVertex& vertex : charts[i]->vertices) {
                    const glm::dvec2 p = vertex.place;
                    const glm::dvec2 place = turned ? glm::dvec2(1.0 - p.y, p.x) : p;
                    vertex.place =
                        (glm::dvec2(rect.x, rect.y) + place * glm::dvec2(rect.width, rect.height)) /
                        static_cast<double>(kAtlasCells);
                }
            }
            break;
        }
        if (fits) return;
    }
}

Mesh SceneBuilder::makeMesh(const Part& part) const {
    const std::vector<Face> faces = facesOf(part.solid);
    const std::vector<glm::vec3> normals = cornerNormals(faces);
    Mesh mesh;
    mesh.name = part.name;
    using Key = std::tuple<size_t, uint32_t, float, float, float>;
    std::map<Key, uint32_t> known;
    for (size_t f = 0; f < faces.size(); ++f) {
        const Chart& chart = part.solid.charts[faces[f].chart];
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
            primitive->texCoord1.emplace_back(vertex.place);
            const glm::dvec2& tile = tiles_[chart.material];
            // They are snapped for the same reason as positions.
            if (tile.x > 0.0)
                primitive->texCoord0.emplace_back(glm::dvec2(snap(glm::dvec3(vertex.texCoord / tile, 0.0))));
        }
    }
    return mesh;
}

Scene SceneBuilder::build() {
    layOut();
    for (const Part& part : parts_) {
        glm::mat4 transform(1.0f);
        transform[3] = glm::vec4(part.position, 1.0f);
        scene_.instances.push_back({part.name, static_cast<int>(scene_.meshes.size()), transform});
        scene_.meshes.push_back(makeMesh(part));
    }
    return std::move(scene_);
}

} // namespace relume::generate
