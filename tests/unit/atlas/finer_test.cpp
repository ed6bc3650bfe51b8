// Scenes whose triangles are split are the same surfaces, without a crack.
#include "assets/generate/generate.h"
#include "assets/generate/finer.h"

#include <array>
#include <map>
#include <utility>

#include <gtest/gtest.h>

namespace relume {
namespace {

using Point = std::array<float, 3>;

// Returns how often each edge of the mesh occurs, by the positions of its ends.
std::map<std::pair<Point, Point>, int> edgesOf(const Mesh& mesh) {
    std::map<std::pair<Point, Point>, int> edges;
    for (const Primitive& primitive : mesh.primitives)
        for (size_t i = 0; i < primitive.indices.size(); ++i) {
            const auto at = [&](size_t corner) -> Point {
                const glm::vec3& p = primitive.positions[primitive.indices[corner]];
                return {p.x, p.y, p.z};
            };
            const Point a = at(i), b = at(i % 3 == 2 ? i - 2 : i + 1);
            ++edges[std::minmax(a, b)];
        }
    return edges;
}

size_t openEdges(const Scene& scene) {
    size_t open = 0;
    for (const Mesh& mesh : scene.meshes)
        for (const auto& [edge, times] : edgesOf(mesh))
            open += edge.first != edge.second && times % 2 == 1;
    return open;
}

struct Sums {
    double area = 0, uvArea = 0;
    size_t triangles = 0;
};
Sums sumsOf(const Scene& scene) {
    Sums sums;
    for (const Mesh& mesh : scene.meshes)
        for (const Primitive& p : mesh.primitives)
            for (size_t i = 0; i < p.indices.size(); i += 3) {
                const uint32_t a = p.indices[i], b = p.indices[i + 1], c = p.indices[i + 2];
                sums.area += 0.5 * glm::length(glm::cross(glm::dvec3(p.positions[b] - p.positions[a]),
                                                          glm::dvec3(p.positions[c] - p.positions[a])));
                const glm::dvec2 u = p.texCoord1[b] - p.texCoord1[a], v = p.texCoord1[c] - p.texCoord1[a];
                sums.uvArea += 0.5 * (u.x * v.y - u.y * v.x);
                ++sums.triangles;
            }
    return sums;
}

TEST(Finer, SplitTrianglesCoverWhatTheyCovered) {
    constexpr uint32_t kParts = 3;
    const Scene scene = generateScene("cornell_geom");
    Scene finer = scene;
    splitTriangles(finer, kParts);
    const Sums before = sumsOf(scene), after = sumsOf(finer);
    EXPECT_EQ(after.triangles, kParts * kParts * before.triangles);
    EXPECT_NEAR(after.area / before.area, 1.0, 1e-5);
    EXPECT_NEAR(after.uvArea / before.uvArea, 1.0, 1e-4) << "of the same side";
    EXPECT_EQ(openEdges(finer), kParts * openEdges(scene)) << "and no crack has opened";
    for (const Mesh& mesh : finer.meshes)
        for (const Primitive& primitive : mesh.primitives) {
            ASSERT_EQ(primitive.normals.size(), primitive.positions.size());
            for (const glm::vec3& normal : primitive.normals)
                ASSERT_NEAR(glm::length(normal), 1.0f, 1e-4f);
        }
}

TEST(Finer, OnePartLeavesAllAsItIs) {
    const Scene scene = generateScene("cornell_small");
    Scene same = scene;
    splitTriangles(same, 1);
    for (size_t i = 0; i < scene.meshes.size(); ++i)
        EXPECT_EQ(same.meshes[i].primitives[0].indices, scene.meshes[i].primitives[0].indices);
}

} // namespace
} // namespace relume
