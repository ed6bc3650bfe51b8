#include "assets/generate/town/town.h"

#include "assets/generate/shapes/solid.h"

#include <algorithm>

namespace relume::generate {
namespace {

// The corner is what has its middle in here [m]: the crossing of street and alley with the houses around it.
constexpr glm::vec2 kCornerLow(-15.0f, -11.6f), kCornerHigh(4.5f, 11.5f); // (x, z)
// Of the triangles of houses one in five is there twice, and one in seven has a copy that faces the other
// way.
constexpr size_t kEveryTwice = 5, kEveryFlipped = 7;

struct Bounds {
    glm::vec3 low{1e30f}, high{-1e30f};
};

Bounds boundsOf(const Scene& scene, const Instance& instance) {
    Bounds bounds;
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
        for (const glm::vec3& position : primitive.positions) {
            const glm::vec3 p(instance.transform * glm::vec4(position, 1.0f));
            bounds.low = glm::min(bounds.low, p);
            bounds.high = glm::max(bounds.high, p);
        }
    return bounds;
}

bool isInCorner(const Bounds& bounds) {
    const glm::vec3 middle = (bounds.low + bounds.high) / 2.0f;
    return middle.x > kCornerLow.x && middle.x < kCornerHigh.x && middle.z > kCornerLow.y &&
           middle.z < kCornerHigh.y;
}

// Appends an instance's triangles of one material, in world space.
void append(Primitive& out, const Primitive& primitive, const glm::mat4& transform) {
    const auto first = static_cast<uint32_t>(out.positions.size());
    // Rotations and uniform scales turn normals as they turn positions; roofs' tiles are scaled almost
    // evenly.
    const glm::mat3 turn(transform);
    for (size_t i = 0; i < primitive.positions.size(); ++i) {
        const glm::dvec3 p(glm::vec3(transform * glm::vec4(primitive.positions[i], 1.0f)));
        out.positions.emplace_back(snap(p));
        out.normals.push_back(glm::normalize(turn * primitive.normals[i]));
        out.texCoord0.push_back(primitive.texCoord0.empty() ? glm::vec2(0.0f) : primitive.texCoord0[i]);
    }
    for (uint32_t index : primitive.indices)
        out.indices.push_back(first + index);
}

// Adds what modelling leaves behind: copies of triangles, and triangles without area.
void spoil(Primitive& primitive) {
    const std::vector<uint32_t> clean = primitive.indices;
    for (size_t t = 0; t + 2 < clean.size(); t += 3) {
        const uint32_t a = clean[t], b = clean[t + 1], c = clean[t + 2];
        if (t / 3 % kEveryTwice == 0) primitive.indices.insert(primitive.indices.end(), {a, b, c});
        if (t / 3 % kEveryFlipped == 0) primitive.indices.insert(primitive.indices.end(), {a, c, b});
    }
    // One with two equal corners, and one whose corners lie on a line.
    const uint32_t a = clean[0], b = clean[1], middle = static_cast<uint32_t>(primitive.positions.size());
    primitive.positions.push_back((primitive.positions[a] + primitive.positions[b]) * 0.5f);
    primitive.normals.push_back(primitive.normals[a]);
    primitive.texCoord0.push_back(primitive.texCoord0[a]);
    primitive.indices.insert(primitive.indices.end(), {a, a, b, a, middle, b});
}

} // namespace

Scene rawCorner() {
    Scene scene = town();
    std::vector<Primitive> merged(scene.materials.size());
    for (const Instance& instance : scene.instances) {
        if (!isInCorner(boundsOf(scene, instance))) continue;
        for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
            append(merged[primitive.material], primitive, instance.transform);
    }
    scene.meshes.clear();
    scene.instances.clear();
    scene.cameras.clear();
    scene.lights.clear();
    scene.sky = {};
    for (size_t material = 0; material < merged.size(); ++material) {
        if (merged[material].indices.empty()) continue;
        Material& paint = scene.materials[material];
        paint.emission = glm::vec3(0.0f); // no lights at all
        // A mesh without picture needs no texture coordinates, but exporters write them for all.
        merged[material].material = static_cast<int>(material);
        spoil(merged[material]);
        scene.instances.push_back({.name = paint.name, .mesh = static_cast<int>(scene.meshes.size())});
        scene.meshes.push_back({.name = paint.name, .primitives = {std::move(merged[material])}});
    }
    return scene;
}

} // namespace relume::generate
