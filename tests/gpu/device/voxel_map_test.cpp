// The CVM pass is held against a test in double precision: every voxel that a triangle touches is set, and
// none that it misses by more than rounding.
#include "bake/trace/voxel_map.h"
#include "bake/vk/buffer.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace relume {
namespace {

using Corners = std::array<glm::vec3, 3>;

/// Makes a scene of triangles that are no receivers, and of nothing else.
TraceScene sceneOf(const std::vector<Corners>& triangles) {
    TraceScene scene;
    scene.size = 1;
    scene.texelToPatch = {shader::kNoPatch};
    for (const Corners& t : triangles) {
        scene.mesh.positions.insert(scene.mesh.positions.end(), t.begin(), t.end());
        scene.mesh.material.push_back(0);
        const glm::vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
        shader::HitTriangle hit{};
        hit.chart = kNoChart;
        hit.representative = shader::kNoPatch;
        hit.normal = glm::length(normal) > 0 ? glm::normalize(normal) : glm::vec3(0, 0, 1);
        scene.hitTriangles.push_back(hit);
    }
    scene.mesh.opaqueCount = scene.mesh.triangleCount();
    return scene;
}

/// Tests separating axes in double precision [Akenine-Moeller 2001]: the box's, the triangle's normal and the
/// nine products of edges; half the box's edge is `half`, its centre the origin.
bool overlaps(const std::array<glm::dvec3, 3>& p, double half) {
    const auto separates = [&](const glm::dvec3& axis) {
        const double a = glm::dot(axis, p[0]), b = glm::dot(axis, p[1]), c = glm::dot(axis, p[2]);
        const double reach = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
        return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
    };
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 unit(0.0);
        unit[axis] = 1.0;
        if (separates(unit)) return false;
        for (size_t k = 0; k < 3; ++k)
            if (separates(glm::cross(unit, p[(k + 1) % 3] - p[k]))) return false;
    }
    return !separates(glm::cross(p[1] - p[0], p[2] - p[0]));
}

class Voxels {
public:
    Voxels(const TraceScene& scene, uint32_t resolution)
        : scene_(scene), map_(testDevice(), scene, {.resolution = resolution}),
          bits_(map_.readBits(testDevice())) {}

    bool set(glm::ivec3 v) const {
        const auto n = static_cast<int>(map_.grid().resolution);
        const auto i = static_cast<uint32_t>((v.z * n + v.y) * n + v.x);
        return (bits_[i / 32] >> i % 32 & 1u) != 0;
    }
    uint64_t count() const { return map_.setVoxels(); }

    /// Returns a triangle in units of voxels.
    std::array<glm::dvec3, 3> triangle(size_t index) const {
        std::array<glm::dvec3, 3> p;
        for (size_t k = 0; k < 3; ++k)
            p[k] = (glm::dvec3(scene_.mesh.positions[3 * index + k]) - glm::dvec3(map_.grid().origin)) *
                   glm::dvec3(map_.grid().scale);
        return p;
    }

private:
    const TraceScene& scene_;
    VoxelMap map_;
    std::vector<uint32_t> bits_;
};

struct Mistakes {
    uint64_t missed = 0, spurious = 0, touched = 0;
};

/// Counts the mistakes among all voxels; one that a triangle grazes within `kTolerance` voxels may be set or
/// not.
Mistakes mistakesOf(const Voxels& voxels, size_t triangles, int resolution) {
    constexpr double kTolerance = 2e-3;
    std::vector<uint8_t> must(size_t(resolution) * resolution * resolution), may(must.size());
    for (size_t t = 0; t < triangles; ++t) {
        const auto p = voxels.triangle(t);
        const glm::ivec3 lo = glm::floor(glm::min(p[0], glm::min(p[1], p[2])) - 0.1);
        const glm::ivec3 hi = glm::floor(glm::max(p[0], glm::max(p[1], p[2])) + 0.1);
        for (int z = std::max(lo.z, 0); z <= std::min(hi.z, resolution - 1); ++z)
            for (int y = std::max(lo.y, 0); y <= std::min(hi.y, resolution - 1); ++y)
                for (int x = std::max(lo.x, 0); x <= std::min(hi.x, resolution - 1); ++x) {
                    const glm::dvec3 centre = glm::dvec3(x, y, z) + 0.5;
                    const std::array<glm::dvec3, 3> q = {p[0] - centre, p[1] - centre, p[2] - centre};
                    const size_t at = (size_t(z) * resolution + y) * resolution + x;
                    must[at] |= overlaps(q, 0.5 - kTolerance) ? 1 : 0;
                    may[at] |= overlaps(q, 0.5 + kTolerance) ? 1 : 0;
                }
    }
    Mistakes mistakes;
    for (int z = 0; z < resolution; ++z)
        for (int y = 0; y < resolution; ++y)
            for (int x = 0; x < resolution; ++x) {
                const size_t at = (size_t(z) * resolution + y) * resolution + x;
                const bool set = voxels.set({x, y, z});
                mistakes.missed += must[at] != 0 && !set;
                mistakes.spurious += may[at] == 0 && set;
                mistakes.touched += must[at];
            }
    return mistakes;
}

enum class Shape { Large, Small, Sliver, Flat, Line };

/// Returns random triangles of one kind, in a box far from the origin, which costs bits.
std::vector<Corners> randomTriangles(Shape shape, uint32_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    std::vector<Corners> triangles;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 a = point();
        glm::vec3 b = point(), c = point();
        if (shape == Shape::Small) b = a + 0.02f * (b - 0.5f), c = a + 0.02f * (c - 0.5f);
        if (shape == Shape::Sliver) c = glm::mix(a, b, unit(random)) + 1e-4f * (c - 0.5f);
        if (shape == Shape::Line) c = glm::mix(a, b, unit(random));
        if (shape == Shape::Flat) b[int(i % 3)] = c[int(i % 3)] = a[int(i % 3)];
        triangles.push_back({a + 10.0f, b + 10.0f, c + 10.0f});
    }
    return triangles;
}

struct MapCase {
    Shape shape;
    uint32_t triangles, resolution;
};
class Conservative : public testing::TestWithParam<MapCase> {};

TEST_P(Conservative, touchedVoxelsAreSetAndNoOthers) {
    const MapCase& c = GetParam();
    const std::vector<Corners> triangles = randomTriangles(c.shape, c.triangles);
    const TraceScene scene = sceneOf(triangles);
    const Voxels voxels(scene, c.resolution);
    const Mistakes mistakes = mistakesOf(voxels, triangles.size(), int(c.resolution));
    EXPECT_EQ(mistakes.missed, 0u) << "of " << mistakes.touched;
    EXPECT_EQ(mistakes.spurious, 0u) << "of " << voxels.count();
    EXPECT_GT(mistakes.touched, c.triangles);
}

INSTANTIATE_TEST_SUITE_P(Triangles, Conservative,
                         testing::Values(MapCase{Shape::Large, 12, 45}, MapCase{Shape::Small, 300, 64},
                                         MapCase{Shape::Sliver, 60, 64}, MapCase{Shape::Flat, 12, 33},
                                         MapCase{Shape::Line, 60, 64}, MapCase{Shape::Large, 2, 200}));

// The bounds' walls lie in the middle of a layer of voxels: that layer is set and no other.
TEST(VoxelMap, wallsOnTheBoundsAreOneLayerThick) {
    const glm::vec3 a(0, 0, 0), b(2, 0, 0), c(2, 2, 0), d(0, 2, 0), up(0, 0, 2);
    const TraceScene scene = sceneOf({{a, b, c}, {a, c, d}, {a + up, b + up, c + up}});
    const Voxels voxels(scene, 40);
    for (int x = 1; x < 39; ++x) {
        for (int y = 1; y < 39; ++y) {
            EXPECT_TRUE(voxels.set({x, y, 0}));
            EXPECT_FALSE(voxels.set({x, y, 1}));
            if (y == x + 1) continue; // the edge meets its corner
            EXPECT_EQ(voxels.set({x, y, 39}), y <= x);
        }
    }
}

// A square's alpha is solid where x < 1: the rest lets light through and sets no voxel.
TEST(VoxelMap, holesOfMaskedTrianglesStayEmpty) {
    const glm::vec3 a(0, 0, 0), b(2, 0, 0), c(2, 2, 0), d(0, 2, 0);
    TraceScene scene = sceneOf({{a, b, c}, {a, c, d}});
    scene.mesh.opaqueCount = 0;
    scene.alphaTriangles = {{{0, 0}, {1, 0}, {1, 1}, 1, 1, 1, 0}, {{0, 0}, {1, 1}, {0, 1}, 1, 1, 1, 0}};
    scene.alphaMaterials = {
        {.factor = 1, .cutoff = 0.5f, .texels = 0, .width = 2, .height = 1, .wrapS = 0, .wrapT = 0}};
    scene.alphaTexels = {255, 0};
    const Voxels voxels(scene, 40);
    for (int x = 0; x < 40; ++x) {
        if (x == 19 || x == 20) continue; // around the edge
        for (int y = 0; y < 40; ++y)
            EXPECT_EQ(voxels.set({x, y, 0}), x < 19) << x << " " << y;
    }
}

// RTRad sets one voxel per pixel, and the last column of pixels falls into the last but one of voxels.
TEST(VoxelMap, rtradSetsOneVoxelPerPixel) {
    const glm::vec3 a(-1, -1, 0.3f), b(1, -1, 0.3f), c(1, 1, 0.3f), d(-1, 1, 0.3f), lo(-1), hi(1);
    TraceScene scene = sceneOf({{a, b, c}, {a, c, d}, {lo, lo, lo}, {hi, hi, hi}});
    scene.rtrad = true;
    const Voxels voxels(scene, 32);
    const int layer = int(std::floor(0.5f * 1.3f * 31.49f));
    EXPECT_EQ(voxels.count(), 31u * 31u);
    EXPECT_TRUE(voxels.set({0, 30, layer}));
    EXPECT_FALSE(voxels.set({31, 31, layer}));
}

} // namespace
} // namespace relume
