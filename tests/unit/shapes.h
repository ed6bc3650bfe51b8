#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "assets/model/scene.h"

namespace relume::test {

inline Primitive primitiveOf(std::vector<glm::vec3> positions, std::vector<uint32_t> indices) {
    Primitive primitive;
    primitive.normals.assign(positions.size(), glm::vec3(0, 0, 1));
    primitive.positions = std::move(positions);
    primitive.indices = std::move(indices);
    return primitive;
}

/// Makes the unit square in z = 0 facing +z, its UVs over [low, high].
inline Primitive square(glm::vec2 low = glm::vec2(0), glm::vec2 high = glm::vec2(1)) {
    Primitive primitive = primitiveOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
    primitive.texCoord1 = {low, {high.x, low.y}, high, {low.x, high.y}};
    return primitive;
}

inline int addMesh(Scene& scene, Primitive primitive, const std::string& name = "Mesh") {
    scene.meshes.push_back({name, {std::move(primitive)}});
    return static_cast<int>(scene.meshes.size()) - 1;
}

inline void addInstance(Scene& scene, int mesh, const glm::mat4& transform = glm::mat4(1)) {
    scene.instances.push_back({"", mesh, transform});
}

inline Scene sceneOf(Primitive primitive) {
    Scene scene;
    scene.path = "test.glb";
    addInstance(scene, addMesh(scene, std::move(primitive)));
    return scene;
}

/// Makes a closed surface over a grid of (u, v) in [0,1]^2, both directions wrapping.
template<typename Surface>
Primitive wrapped(uint32_t nu, uint32_t nv, const Surface& surface) {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t v = 0; v < nv; ++v)
        for (uint32_t u = 0; u < nu; ++u)
            positions.push_back(surface(u / float(nu), v / float(nv)));
    for (uint32_t v = 0; v < nv; ++v)
        for (uint32_t u = 0; u < nu; ++u) {
            const uint32_t a = v * nu + u, b = v * nu + (u + 1) % nu;
            const uint32_t c = (v + 1) % nv * nu + u, d = (v + 1) % nv * nu + (u + 1) % nu;
            indices.insert(indices.end(), {a, b, d, a, d, c});
        }
    return primitiveOf(positions, indices);
}

/// Makes a tube around the (2,3) torus knot.
inline Primitive torusKnot(uint32_t along = 400, uint32_t around = 24) {
    constexpr float kTurn = 6.28318531f;
    const auto centre = [](float t) {
        const float r = 2.0f + std::cos(3.0f * t);
        return glm::vec3(r * std::cos(2.0f * t), r * std::sin(2.0f * t), std::sin(3.0f * t));
    };
    return wrapped(along, around, [&](float u, float v) {
        const glm::vec3 here = centre(kTurn * u), ahead = glm::normalize(centre(kTurn * u + 1e-2f) - here);
        const glm::vec3 side = glm::normalize(glm::cross(ahead, here)), up = glm::cross(side, ahead);
        return here + 0.4f * (std::cos(kTurn * v) * side + std::sin(kTurn * v) * up);
    });
}

/// Makes a sphere by latitude and longitude, with triangles without area at the poles.
inline Primitive sphere(uint32_t n = 64) {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t v = 0; v <= n; ++v)
        for (uint32_t u = 0; u < 2 * n; ++u) {
            const float theta = 3.14159265f * float(v) / float(n), phi = 3.14159265f * float(u) / float(n);
            const float r = v == 0 || v == n ? 0.0f : std::sin(theta);
            positions.push_back({r * std::cos(phi), r * std::sin(phi), std::cos(theta)});
        }
    for (uint32_t v = 0; v < n; ++v)
        for (uint32_t u = 0; u < 2 * n; ++u) {
            const uint32_t a = v * 2 * n + u, b = v * 2 * n + (u + 1) % (2 * n);
            indices.insert(indices.end(), {a, a + 2 * n, b + 2 * n, a, b + 2 * n, b});
        }
    return primitiveOf(positions, indices);
}

inline Primitive cube() {
    Primitive primitive;
    for (int axis = 0; axis < 3; ++axis)
        for (float side : {0.0f, 1.0f}) {
            const uint32_t base = static_cast<uint32_t>(primitive.positions.size());
            for (const glm::vec2 corner :
                 {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
                glm::vec3 p;
                p[axis] = side;
                p[(axis + 1) % 3] = corner.x;
                p[(axis + 2) % 3] = corner.y;
                primitive.positions.push_back(p);
            }
            const bool flip = side == 0.0f;
            for (uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u})
                primitive.indices.push_back(base + (flip ? (4 - i) % 4 : i));
        }
    primitive.normals.assign(primitive.positions.size(), glm::vec3(0, 0, 1));
    return primitive;
}

/// Makes triangles with no order at all that share vertices at random.
inline Primitive soup(uint32_t triangles, uint32_t vertices, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<glm::vec3> positions(vertices);
    for (glm::vec3& p : positions)
        p = {unit(random), unit(random), unit(random)};
    std::vector<uint32_t> indices;
    while (indices.size() < 3 * triangles) {
        const uint32_t a = random() % vertices, b = random() % vertices, c = random() % vertices;
        if (a != b && b != c && c != a) indices.insert(indices.end(), {a, b, c});
    }
    return primitiveOf(positions, indices);
}

} // namespace relume::test
