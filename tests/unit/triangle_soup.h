#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include "assets/model/scene.h"

namespace relume {

/// Holds a triangle of a scene in world space, in double precision.
struct SoupTriangle {
    glm::dvec3 position[3];
    glm::dvec3 shadingNormal[3];
    glm::dvec2 uv[3]{}; // TEXCOORD_1, where there is one
    glm::dvec3 normal{0.0};
    double area = 0.0; // [m^2]
    int instance = -1;
};

inline std::vector<SoupTriangle> trianglesOf(const Scene& scene) {
    std::vector<SoupTriangle> triangles;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const glm::dmat4 transform(scene.instances[i].transform);
        const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3(transform)));
        for (const Primitive& primitive : scene.meshes[scene.instances[i].mesh].primitives)
            for (size_t k = 0; k + 2 < primitive.indices.size(); k += 3) {
                SoupTriangle t;
                t.instance = static_cast<int>(i);
                for (int c = 0; c < 3; ++c) {
                    const uint32_t index = primitive.indices[k + c];
                    t.position[c] = glm::dvec3(transform * glm::dvec4(primitive.positions[index], 1.0));
                    const glm::dvec3 normal(primitive.normals[index]);
                    t.shadingNormal[c] = glm::length(normal) * glm::normalize(turn * normal);
                    if (!primitive.texCoord1.empty()) t.uv[c] = primitive.texCoord1[index];
                }
                const glm::dvec3 cross =
                    glm::cross(t.position[1] - t.position[0], t.position[2] - t.position[0]);
                t.area = glm::length(cross) / 2.0;
                t.normal = cross / (2.0 * t.area);
                triangles.push_back(t);
            }
    }
    return triangles;
}

struct SoupHit {
    int triangle = -1; // -1: none
    double distance = std::numeric_limits<double>::infinity();
};

/// Finds closest hits among triangles, for tests that must not lean on the tracers they check.
class TriangleSoup {
public:
    explicit TriangleSoup(std::vector<SoupTriangle> triangles) : triangles_(std::move(triangles)) {
        order_.resize(triangles_.size());
        for (size_t i = 0; i < order_.size(); ++i)
            order_[i] = static_cast<int>(i);
        split(0, static_cast<int>(order_.size()));
    }

    const std::vector<SoupTriangle>& triangles() const { return triangles_; }

    SoupHit closest(const glm::dvec3& origin, const glm::dvec3& direction) const {
        SoupHit hit;
        visit(0, origin, direction, hit);
        return hit;
    }

private:
    struct Node {
        glm::dvec3 low{1e30}, high{-1e30};
        int first = 0, last = 0;
        int right = 0; // 0: a leaf; the left child follows its parent
    };

    void split(int first, int last) {
        const size_t index = nodes_.size();
        nodes_.emplace_back();
        Node node;
        node.first = first;
        node.last = last;
        for (int i = first; i < last; ++i)
            for (const glm::dvec3& p : triangles_[order_[i]].position) {
                node.low = glm::min(node.low, p);
                node.high = glm::max(node.high, p);
            }
        if (last - first > 4) {
            const glm::dvec3 size = node.high - node.low;
            const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
            const auto centre = [&](int i) {
                const SoupTriangle& t = triangles_[i];
                return t.position[0][axis] + t.position[1][axis] + t.position[2][axis];
            };
            const int middle = (first + last) / 2;
            std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                             [&](int a, int b) { return centre(a) < centre(b); });
            split(first, middle);
            node.right = static_cast<int>(nodes_.size());
            split(middle, last);
        }
        nodes_[index] = node;
    }

    void visit(int index, const glm::dvec3& origin, const glm::dvec3& direction, SoupHit& hit) const {
        const Node& node = nodes_[index];
        const glm::dvec3 a = (node.low - 1e-9 - origin) / direction,
                         b = (node.high + 1e-9 - origin) / direction;
        const glm::dvec3 enter = glm::min(a, b), leave = glm::max(a, b);
        const double from = std::max({enter.x, enter.y, enter.z, 0.0}),
                     to = std::min({leave.x, leave.y, leave.z});
        if (from > to || from > hit.distance) return;
        if (node.right) {
            visit(index + 1, origin, direction, hit);
            visit(node.right, origin, direction, hit);
            return;
        }
        for (int i = node.first; i < node.last; ++i)
            test(order_[i], origin, direction, hit);
    }

    void test(int index, const glm::dvec3& origin, const glm::dvec3& direction, SoupHit& hit) const {
        const SoupTriangle& t = triangles_[index];
        const glm::dvec3 a = t.position[0] - origin, b = t.position[1] - origin, c = t.position[2] - origin;
        const double u = glm::dot(direction, glm::cross(c, b)), v = glm::dot(direction, glm::cross(a, c)),
                     w = glm::dot(direction, glm::cross(b, a));
        if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return;
        const double facing = glm::dot(direction, t.normal);
        if (facing == 0.0) return;
        const double distance = glm::dot(a, t.normal) / facing;
        if (distance <= 0.0 || distance >= hit.distance) return;
        hit = {index, distance};
    }

    std::vector<SoupTriangle> triangles_;
    std::vector<int> order_;
    std::vector<Node> nodes_;
};

} // namespace relume
