#include "tests/gpu/bake_scene.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/world_mesh.h"
#include "assets/base/error.h"
#include "assets/images/metrics.h"
#include "bake/trace/make_tracer.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

namespace relume {
namespace {

constexpr uint32_t kGap = 1;         // texels between charts
constexpr uint32_t kDiscSides = 256; // area within 1e-4 of the disc's

// Makes a surface over the unit square, cut into cells x cells pieces of two triangles each.
Primitive patchwork(uint32_t cells, const std::function<glm::dvec3(glm::dvec2)>& position,
                    const std::function<glm::dvec3(glm::dvec2)>& normal,
                    const std::function<glm::vec2(glm::dvec2)>& lightmapUv) {
    Primitive primitive;
    for (uint32_t row = 0; row <= cells; ++row) {
        for (uint32_t column = 0; column <= cells; ++column) {
            const glm::dvec2 st(double(column) / cells, double(row) / cells);
            primitive.positions.emplace_back(position(st));
            primitive.normals.emplace_back(normal(st));
            primitive.texCoord0.emplace_back(st);
            if (lightmapUv) primitive.texCoord1.push_back(lightmapUv(st));
        }
    }
    for (uint32_t row = 0; row < cells; ++row) {
        for (uint32_t column = 0; column < cells; ++column) {
            const uint32_t a = row * (cells + 1) + column, b = a + 1, c = a + cells + 2, d = a + cells + 1;
            primitive.indices.insert(primitive.indices.end(), {a, b, c, a, c, d});
        }
    }
    return primitive;
}

Primitive flat(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v,
               const std::function<glm::vec2(glm::dvec2)>& lightmapUv) {
    const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
    return patchwork(
        1, [=](glm::dvec2 st) { return corner + st.x * u + st.y * v; }, [=](glm::dvec2) { return normal; },
        lightmapUv);
}

} // namespace

int SceneMaker::material(float albedo, float emission) {
    Material m;
    m.baseColor = glm::vec4(albedo, albedo, albedo, 1.0f);
    m.emission = glm::vec3(emission);
    m.metallic = 0.0f;
    return material(m);
}

int SceneMaker::material(const Material& material) {
    scene_.materials.push_back(material);
    return static_cast<int>(scene_.materials.size()) - 1;
}

int SceneMaker::alphaTexture(uint32_t width, uint32_t height, const std::vector<uint8_t>& alpha) {
    Image image{"alpha", width, height, {}};
    for (uint8_t a : alpha)
        image.rgba.insert(image.rgba.end(), {255, 255, 255, a});
    scene_.images.push_back(image);
    scene_.textures.push_back({.image = static_cast<int>(scene_.images.size()) - 1,
                               .wrapS = Wrap::ClampToEdge,
                               .wrapT = Wrap::ClampToEdge,
                               .nearest = true});
    return static_cast<int>(scene_.textures.size()) - 1;
}

// Places a chart; charts fill the lightmap in shelves from the top.
TexelRect SceneMaker::place(glm::uvec2 texels) {
    if (shelfX_ + texels.x > size_) {
        shelfY_ += shelfHeight_ + kGap;
        shelfX_ = shelfHeight_ = 0;
    }
    const TexelRect rect{shelfX_, shelfY_, texels.x, texels.y};
    shelfX_ += texels.x + kGap;
    shelfHeight_ = std::max(shelfHeight_, texels.y);
    ASSERT(rect.x + rect.width <= size_ && rect.y + rect.height <= size_);
    return rect;
}

glm::vec2 SceneMaker::uvAt(const TexelRect& rect, glm::dvec2 st) const {
    return glm::vec2((glm::dvec2(rect.x, rect.y) + st * glm::dvec2(rect.width, rect.height)) / double(size_));
}

void SceneMaker::add(Primitive primitive) {
    const std::string name = "surface " + std::to_string(scene_.meshes.size());
    scene_.instances.push_back({name, static_cast<int>(scene_.meshes.size()), glm::mat4(1.0f)});
    scene_.meshes.push_back({name, {std::move(primitive)}});
}

TexelRect SceneMaker::quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v, int material, glm::uvec2 texels) {
    const TexelRect rect = place(texels);
    Primitive primitive = flat(corner, u, v, [&](glm::dvec2 st) { return uvAt(rect, st); });
    primitive.material = material;
    add(std::move(primitive));
    return rect;
}

void SceneMaker::blocker(glm::vec3 corner, glm::vec3 u, glm::vec3 v, int material) {
    Primitive primitive = flat(corner, u, v, nullptr);
    primitive.texCoord0.clear();
    primitive.material = material;
    add(std::move(primitive));
}

TexelRect SceneMaker::disc(glm::vec3 centre, glm::vec3 u, glm::vec3 v, int material, uint32_t texels) {
    const TexelRect rect = place({texels, texels});
    const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(u), glm::dvec3(v)));
    Primitive primitive;
    primitive.material = material;
    const auto corner = [&](glm::dvec2 p) { // p in the unit disc
        primitive.positions.emplace_back(glm::dvec3(centre) + p.x * glm::dvec3(u) + p.y * glm::dvec3(v));
        primitive.normals.emplace_back(normal);
        primitive.texCoord0.emplace_back(0.5 + 0.5 * p);
        primitive.texCoord1.push_back(uvAt(rect, 0.5 + 0.5 * p));
    };
    corner(glm::dvec2(0.0));
    for (uint32_t i = 0; i < kDiscSides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kDiscSides;
        corner({std::cos(angle), std::sin(angle)});
        primitive.indices.insert(primitive.indices.end(), {0, 1 + i, 1 + (i + 1) % kDiscSides});
    }
    add(std::move(primitive));
    return rect;
}

std::array<TexelRect, 6> SceneMaker::box(glm::vec3 corner, const std::array<glm::vec3, 3>& edges,
                                         const std::array<int, 6>& materials,
                                         const std::array<glm::uvec2, 6>& texels) {
    std::array<TexelRect, 6> rects;
    for (size_t axis = 0; axis < 3; ++axis) {
        const glm::vec3 u = edges[(axis + 1) % 3], v = edges[(axis + 2) % 3]; // u x v along the axis
        rects[axis] = quad(corner, u, v, materials[axis], texels[axis]);
        // The far wall's columns run backwards, which turns its front inwards.
        rects[axis + 3] = quad(corner + edges[axis] + u, -u, v, materials[axis + 3], texels[axis + 3]);
    }
    return rects;
}

std::array<TexelRect, 6> SceneMaker::box(glm::vec3 corner, const std::array<glm::vec3, 3>& edges,
                                         int material, uint32_t texels) {
    std::array<int, 6> materials;
    materials.fill(material);
    std::array<glm::uvec2, 6> counts;
    counts.fill(glm::uvec2(texels));
    return box(corner, edges, materials, counts);
}

std::array<TexelRect, 6> SceneMaker::sphere(glm::vec3 centre, float radius,
                                            const std::array<int, 6>& materials, uint32_t texels) {
    std::array<TexelRect, 6> rects;
    for (size_t face = 0; face < 6; ++face) {
        const TexelRect rect = rects[face] = place({texels, texels});
        const double side = face < 3 ? 1.0 : -1.0;
        // Equal angles instead of equal lengths keep the cells alike.
        const auto direction = [=](glm::dvec2 st) {
            const glm::dvec2 angle = (st - 0.5) * (0.5 * std::numbers::pi);
            const glm::dvec3 d(side, -side * std::tan(angle.x), std::tan(angle.y));
            const size_t axis = face % 3;
            glm::dvec3 turned;
            turned[int(axis)] = d.x;
            turned[int((axis + 1) % 3)] = d.y;
            turned[int((axis + 2) % 3)] = d.z;
            return glm::normalize(turned);
        };
        Primitive primitive = patchwork(
            texels, [&](glm::dvec2 st) { return glm::dvec3(centre) + double(radius) * direction(st); },
            [&](glm::dvec2 st) { return -direction(st); }, [&](glm::dvec2 st) { return uvAt(rect, st); });
        primitive.material = materials[face];
        add(std::move(primitive));
    }
    return rects;
}

BakeSettings settingsOf(const BakeDesc& desc) {
    BakeSettings settings;
    settings.size = desc.size;
    settings.tracer = desc.tracer;
    settings.voxels = desc.voxels;
    settings.solver.passes = desc.passes;
    settings.solver.error = desc.error;
    settings.solver.localError = desc.localError;
    settings.solver.links.perChunk = desc.perChunk;
    settings.solver.links.allOver = desc.allOver;
    settings.solver.batchMs = desc.batchMs;
    settings.solver.method = desc.method;
    settings.solver.links.samples = desc.samples;
    settings.solver.links.smooth = desc.smooth;
    settings.solver.links.directions = desc.directions;
    settings.solver.links.rotation = desc.rotation;
    settings.solver.links.indirectScale = desc.indirectScale;
    settings.solver.links.footprint = desc.footprint;
    settings.solver.cache = desc.cache;
    settings.solver.pairs = desc.pairs;
    settings.solver.transport.rtrad = desc.rtrad;
    settings.solver.transport.deviceGather = desc.deviceGather;
    settings.solver.live = desc.live;
    settings.solver.spill = desc.spill;
    settings.solver.layers = {.on = desc.layers,
                              .bytes = desc.layerBytes,
                              .deviceBytes = desc.layerDeviceBytes,
                              .error = desc.layerError};
    if (desc.rtrad) settings.solver.transport.reflectivity = 0.9f;
    return settings;
}

namespace {

WorldMesh meshOf(const Scene& scene, uint32_t size) {
    return flatten(scene, buildAtlas(scene, size));
}

const vk::Device& deviceOf(const BakeDesc& desc) {
    return desc.device != nullptr ? *desc.device : testDevice();
}

} // namespace

std::unique_ptr<Baker> makeBaker(const Scene& scene, const BakeDesc& desc) {
    return std::make_unique<Baker>(deviceOf(desc), scene, meshOf(scene, desc.size), settingsOf(desc));
}

std::unique_ptr<Baker> makeEditableBaker(Scene& scene, const BakeDesc& desc) {
    return std::make_unique<Baker>(deviceOf(desc), scene, meshOf(scene, desc.size), settingsOf(desc));
}

Baked bakeScene(const Scene& scene, const BakeDesc& desc) {
    const std::unique_ptr<Baker> baker = makeBaker(scene, desc);
    while (!baker->solver().done())
        baker->solver().step();
    return {.lighting = baker->lightmap({.quantity = Quantity::Lighting, .sew = false}),
            .radiance = baker->lightmap({.quantity = Quantity::Radiance, .sew = false}),
            .progress = baker->solver().progress(),
            .patches = baker->patches(),
            .invalid = baker->invalidPatches()};
}

std::vector<TracerKind> tracersOfTestDevice() {
    std::vector<TracerKind> kinds;
    for (TracerKind kind : {TracerKind::Embree, TracerKind::Bvh, TracerKind::Query, TracerKind::Rtp}) {
        if (tracerProblem(kind, testDevice().info()).empty()) kinds.push_back(kind);
    }
    return kinds;
}

void expectTracersAgree(const Scene& scene, BakeDesc desc, double tolerance) {
    std::optional<Baked> first;
    for (const TracerKind kind : tracersOfTestDevice()) {
        desc.tracer = kind;
        Baked baked = bakeScene(scene, desc);
        if (!first)
            first = std::move(baked);
        else
            EXPECT_LT(relativeError(baked.lighting, first->lighting), tolerance) << tracerName(kind);
    }
}

Scene scaled(Scene scene, float factor) {
    for (Instance& instance : scene.instances) {
        for (int column = 0; column < 4; ++column)
            instance.transform[column] *= glm::vec4(factor, factor, factor, 1.0f);
    }
    return scene;
}

TexelStatistics statistics(const FloatImage& image, const TexelRect& rect) {
    TexelStatistics s{0.0, std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest(), 0};
    for (uint32_t row = 0; row < rect.height; ++row) {
        for (uint32_t column = 0; column < rect.width; ++column) {
            const size_t i = size_t{rect.y + row} * image.width + rect.x + column;
            if ((*image.find("coverage"))[i] != 1.0f) continue;
            const double value = image.planes[0][i];
            s.mean += value;
            s.min = std::min(s.min, value);
            s.max = std::max(s.max, value);
            ++s.count;
        }
    }
    s.mean /= s.count;
    return s;
}

double texel(const FloatImage& image, const TexelRect& rect, uint32_t column, uint32_t row) {
    return image.planes[0][size_t{rect.y + row} * image.width + rect.x + column];
}

double relativeError(const FloatImage& a, const FloatImage& b) {
    return compareImages(a, "a", b, "b").relRmse;
}

} // namespace relume
