#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {

namespace {

struct MeshBox {
    glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
};

MeshBox boxOf(const Mesh& mesh) {
    MeshBox box;
    for (const Primitive& primitive : mesh.primitives)
        for (const uint32_t index : primitive.indices) {
            box.low = glm::min(box.low, glm::dvec3(primitive.positions[index]));
            box.high = glm::max(box.high, glm::dvec3(primitive.positions[index]));
        }
    return box;
}

glm::dvec3 cornerOf(const MeshBox& box, int corner) {
    return {(corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
            (corner & 4) != 0 ? box.high.z : box.low.z};
}

bool isWithin(const MeshBox& box, const glm::mat4& transform) {
    if (box.low.x > box.high.x) return true;
    for (int corner = 0; corner < 8; ++corner)
        if (!isWithinReach(glm::vec3(glm::dmat4(transform) * glm::dvec4(cornerOf(box, corner), 1.0))))
            return false;
    return true;
}

// Returns the box of all that stands in a scene.
MeshBox boxOf(const Scene& scene) {
    std::vector<MeshBox> boxes(scene.meshes.size());
    for (size_t m = 0; m < boxes.size(); ++m)
        boxes[m] = boxOf(scene.meshes[m]);
    MeshBox all;
    for (const Instance& instance : scene.instances) {
        const MeshBox& box = boxes[static_cast<size_t>(instance.mesh)];
        if (box.low.x > box.high.x) continue;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 at = glm::dmat4(instance.transform) * glm::dvec4(cornerOf(box, corner), 1.0);
            all.low = glm::min(all.low, at);
            all.high = glm::max(all.high, at);
        }
    }
    return all;
}

bool isFar(const glm::mat4& transform, const glm::vec3& position) {
    return !isWithinReach(glm::vec3(transform * glm::vec4(position, 1.0f)));
}

/// Tells whether a corner of a triangle is far.
bool reachesFar(const Primitive& primitive, size_t first, const glm::mat4& transform) {
    const auto far = [&](size_t k) {
        return isFar(transform, primitive.positions[primitive.indices[first + k]]);
    };
    return far(0) || far(1) || far(2);
}

size_t countFar(const Mesh& mesh, const glm::mat4& transform) {
    size_t count = 0;
    for (const Primitive& primitive : mesh.primitives)
        for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
            count += reachesFar(primitive, i, transform);
    return count;
}

void dropFrom(Mesh& mesh, const glm::mat4& transform) {
    for (Primitive& primitive : mesh.primitives) {
        std::vector<uint32_t> kept;
        for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
            if (!reachesFar(primitive, i, transform))
                kept.insert(kept.end(), &primitive.indices[i], &primitive.indices[i] + 3);
        primitive.indices = std::move(kept);
        for (glm::vec3& position : primitive.positions)
            if (isFar(transform, position)) position = glm::vec3(0.0f); // no triangle uses it from here on
    }
    std::erase_if(mesh.primitives, [](const Primitive& primitive) { return primitive.indices.empty(); });
}

float brightestOf(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// Cuts a value to at most `most` and returns whether it changed.
template<typename Vec>
bool cut(Vec& value, float most) {
    const Vec before = value;
    value = glm::min(value, Vec(most));
    return value != before;
}

/// Tells whether the axes of a transform are numbers.
bool isTurned(const glm::mat4& transform) {
    for (int column = 0; column < 3; ++column)
        if (!std::isfinite(glm::dot(transform[column], glm::vec4(1.0f)))) return false;
    return true;
}

std::string tooFar(const char* thing) {
    return fmt::format("its {} is more than {:g} m and is cut to that", thing, kFarthest);
}

std::string tooBright(const char* unit) {
    return fmt::format("is brighter than {:g} {} and is dimmed to that", kBrightest, unit);
}

const char* unitOf(LightType type) {
    if (type == LightType::Directional) return "lux";
    return type == LightType::Point || type == LightType::Spot ? "cd" : "cd/m^2";
}

} // namespace

bool isWithinReach(const glm::vec3& point) {
    return std::abs(point.x) <= kFarthest && std::abs(point.y) <= kFarthest && std::abs(point.z) <= kFarthest;
}

bool isWithinReach(const Mesh& mesh, const glm::mat4& transform) {
    return isWithin(boxOf(mesh), transform) || countFar(mesh, transform) == 0;
}

std::string farTriangles(size_t count) {
    return fmt::format("{} of its triangles reach beyond {:g} m and are dropped: make it smaller or move it",
                       count, kFarthest);
}

void dropFarTriangles(Scene& scene, Warnings& warnings) {
    std::vector<size_t> users(scene.meshes.size());
    for (const Instance& instance : scene.instances)
        ++users[static_cast<size_t>(instance.mesh)];
    std::vector<MeshBox> boxes(scene.meshes.size());
    for (size_t m = 0; m < boxes.size(); ++m)
        if (users[m] > 0) boxes[m] = boxOf(scene.meshes[m]);
    std::vector<size_t> dropped(scene.meshes.size());
    for (Instance& instance : scene.instances) {
        const size_t mesh = static_cast<size_t>(instance.mesh);
        if (isWithin(boxes[mesh], instance.transform)) continue;
        const size_t count = countFar(scene.meshes[mesh], instance.transform);
        if (count == 0) continue;
        dropped[mesh] += count;
        if (users[mesh] > 1) {
            --users[mesh];
            Mesh copy = scene.meshes[mesh];
            scene.meshes.push_back(std::move(copy));
            instance.mesh = static_cast<int>(scene.meshes.size()) - 1;
        }
        dropFrom(scene.meshes[static_cast<size_t>(instance.mesh)], instance.transform);
    }
    for (size_t m = 0; m < dropped.size(); ++m) {
        const std::string& name = scene.meshes[m].name;
        if (dropped[m] > 0)
            warnings.add(name.empty() ? fmt::format("mesh {}", m) : "mesh " + inQuotes(name),
                         farTriangles(dropped[m]));
    }
    std::erase_if(scene.instances, [&](const Instance& instance) {
        return scene.meshes[static_cast<size_t>(instance.mesh)].primitives.empty();
    });
}

std::string coarsePlaces(const Scene& scene) {
    constexpr double kMostShare = 5e-5; // of the scene's diagonal: 7 mm of 140 m show as rings at contacts
    const MeshBox box = boxOf(scene);
    if (box.low.x > box.high.x) return "";
    const glm::dvec3 reach = glm::max(glm::abs(box.low), glm::abs(box.high));
    const double farthest = std::max({reach.x, reach.y, reach.z});
    const double step = std::ldexp(1.0, std::ilogb(static_cast<float>(std::max(farthest, 1e-30))) -
                                            (std::numeric_limits<float>::digits - 1));
    if (step <= kMostShare * glm::length(box.high - box.low)) return "";
    return fmt::format(
        "lies up to {:.3g} m from the origin, where places are rounded to {:.2g} m, which shows "
        "where things touch: move all of it nearer",
        farthest, step);
}

std::vector<std::string> limitLight(Light& light) {
    std::vector<std::string> mended;
    if (cut(light.size, kFarthest)) mended.push_back(tooFar("size"));
    if (cut(light.radius, kFarthest)) mended.push_back(tooFar("radius"));
    // Where the colour's channels are above 1, the intensity alone does not tell the brightness.
    const double brightest = std::max(brightestOf(light.color), 1.0f);
    if (light.intensity * brightest > kBrightest * (1.0 + std::numeric_limits<float>::epsilon())) {
        light.intensity = static_cast<float>(kBrightest / brightest);
        mended.push_back(tooBright(unitOf(light.type)));
    }
    return mended;
}

std::vector<std::string> limitMaterial(Material& material) {
    if (!cut(material.emission, kBrightest)) return {};
    return {"emits more than " + fmt::format("{:g} cd/m^2 and is dimmed to that", kBrightest)};
}

std::vector<std::string> limitSky(Sky& sky) {
    size_t tooMuch = 0;
    float brightest = 0.0f;
    for (glm::vec3& pixel : sky.pixels) {
        tooMuch += cut(pixel, kBrightest);
        brightest = std::max(brightest, brightestOf(pixel));
    }
    std::vector<std::string> mended;
    if (tooMuch > 0)
        mended.push_back(
            fmt::format("{} of its {} pixels are brighter than {:g} cd/m^2 and are dimmed to that", tooMuch,
                        sky.pixels.size(), kBrightest));
    const float most = kBrightest / std::max(brightest, 1.0f);
    if (cut(sky.radiance, most)) mended.push_back(tooBright("cd/m^2"));
    return mended;
}

void limitEdits(const Scene& scene, const SceneEdits& before, SceneEdits& edits) {
    for (size_t i = 0; i < edits.lights.size(); ++i) {
        Light& light = edits.lights[i];
        light.color = glm::min(light.color, glm::vec3(kBrightest)); // an infinite one times 0 is no number
        limitLight(light);
        if (!isTurned(light.transform))
            light.transform = i < before.lights.size() ? before.lights[i].transform : glm::mat4(1.0f);
        for (int c = 0; c < 3; ++c)
            light.transform[3][c] = std::clamp(light.transform[3][c], -kFarthest, kFarthest);
    }
    for (Material& material : edits.materials)
        limitMaterial(material);
    cut(edits.sky.radiance, kBrightest);
    if (!std::isfinite(edits.sky.rotation)) edits.sky.rotation = before.sky.rotation;
    for (size_t i = 0; i < edits.placements.size(); ++i) {
        glm::mat4& transform = edits.placements[i].transform;
        if (transform == before.placements[i].transform) continue;
        const Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
        if (!isWithinReach(mesh, transform)) transform = before.placements[i].transform;
    }
}

} // namespace relume
