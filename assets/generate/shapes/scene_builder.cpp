#include "assets/generate/shapes/scene_builder.h"

#include "assets/atlas/rect_pack.h"
#include "assets/base/error.h"
#include "assets/model/panes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

namespace relume::generate {
namespace {

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

/// Returns the transform of an instance. Sine and cosine are snapped as coordinates are.
glm::mat4 transformOf(const Placement& placement) {
    const double angle = glm::radians(placement.turn);
    const glm::dvec2 turn = glm::normalize(glm::dvec2(snap({std::cos(angle), std::sin(angle), 0.0})));
    const glm::dvec3 scale = snap(placement.scale);
    glm::mat4 transform(1.0f);
    transform[0] = glm::vec4(scale.x * glm::dvec4(turn.x, 0.0, 0.0 - turn.y, 0.0));
    transform[1] = glm::vec4(scale.y * glm::dvec4(0.0, 1.0, 0.0, 0.0));
    transform[2] = glm::vec4(scale.z * glm::dvec4(turn.y, 0.0, turn.x, 0.0));
    transform[3] = glm::vec4(snap(placement.position), 1.0f);
    return transform;
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

int SceneBuilder::masked(const std::string& name, Image image, const glm::dvec2& tile) {
    const int material = textured(name, std::move(image), tile);
    scene_.materials.back().alphaMode = AlphaMode::Mask;
    scene_.materials.back().doubleSided = true;
    return material;
}

int SceneBuilder::glass(const std::string& name, const glm::vec4& color) {
    const int material = paint(name, glm::vec3(color));
    Material& glass = scene_.materials.back();
    glass.baseColor = color;
    glass.alphaMode = AlphaMode::Blend;
    glass.doubleSided = true;
    return material;
}

int SceneBuilder::share(const std::string& name, Solid solid, Batched batched) {
    parts_.push_back({name, std::move(solid), {}, batched});
    return static_cast<int>(parts_.size()) - 1;
}

void SceneBuilder::place(int part, const std::string& name, const Placement& placement) {
    parts_[part].instances.push_back({.name = name, .mesh = part, .transform = transformOf(placement)});
}

void SceneBuilder::place(int part, const Placement& placement) {
    place(part, parts_[part].name + " " + std::to_string(parts_[part].instances.size() + 1), placement);
}

void SceneBuilder::add(const std::string& name, Solid solid, const glm::dvec3& position) {
    place(share(name, std::move(solid)), name, {.position = position});
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
    for (Part& part : parts_) {
        ASSERT(part.instances.size() == 1);
        for (Chart& chart : part.solid.charts) {
            charts.push_back(&chart);
            area += chart.size.x * chart.size.y * chart.density * chart.density;
        }
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

Scene SceneBuilder::assemble(LightmapUvs uvs) {
    for (const Part& part : parts_) {
        scene_.instances.insert(scene_.instances.end(), part.instances.begin(), part.instances.end());
        scene_.meshes.push_back(meshOf(part.name, part.solid, tiles_, uvs));
        scene_.meshes.back().batched = part.batched == Batched::Yes;
    }
    markPanes(scene_);
    return std::move(scene_);
}

Scene SceneBuilder::build() {
    layOut();
    return assemble(LightmapUvs::Places);
}

Scene SceneBuilder::buildWithoutAtlas() {
    return assemble(LightmapUvs::None);
}

} // namespace relume::generate
