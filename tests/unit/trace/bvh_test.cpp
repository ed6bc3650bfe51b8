#include "bake/trace/bvh_builder.h"

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/bvh_walk.h"
#include "tests/unit/trace_world.h"

namespace relume {
namespace {

using shader::BvhNode;
using shader::BvhWalk;

WorldMesh meshOf(const std::vector<glm::vec3>& corners) {
    WorldMesh mesh;
    mesh.positions = corners;
    mesh.material.assign(corners.size() / 3, 0);
    mesh.opaqueCount = mesh.triangleCount();
    return mesh;
}

// Walks the whole tree; counts how often each triangle is met and checks that all boxes above hold it.
void checkSubtree(const Bvh& bvh, int child, glm::vec3 lo, glm::vec3 hi, std::vector<int>& met) {
    if (child >= 0) {
        const BvhNode& node = bvh.nodes.at(size_t(child));
        for (int side = 0; side < 2; ++side) {
            const BvhBox box = childBox(node, side);
            const int below = side == 0 ? node.child0 : node.child1;
            EXPECT_TRUE(below < 0 || below > child) << "not depth first";
            checkSubtree(bvh, below, glm::max(lo, box.lo), glm::min(hi, box.hi), met);
        }
        return;
    }
    const uint32_t first = uint32_t(~child) >> 3, count = uint32_t(~child) & 7;
    EXPECT_TRUE(count >= 1 && count <= 4);
    for (uint32_t i = first; i < first + count; ++i) {
        const shader::BvhTriangle& triangle = bvh.triangles.at(i);
        ++met.at(triangle.id & 0x7fffffffu);
        for (const glm::vec3& p : {triangle.p0, triangle.p1, triangle.p2})
            EXPECT_TRUE(glm::all(glm::greaterThan(p, lo)) && glm::all(glm::lessThan(p, hi)));
    }
}

void checkTree(const WorldMesh& mesh, const Bvh& bvh, int perTriangle = 1) {
    std::vector<int> met(mesh.triangleCount(), 0);
    checkSubtree(bvh, 0, glm::vec3(-1e30f), glm::vec3(1e30f), met);
    EXPECT_LE(bvh.depth, shader::kBvhDepth);
    for (int count : met)
        EXPECT_EQ(count, perTriangle);
}

TEST(Bvh, holdsEveryTriangleOnceInsideItsBoxes) {
    const TraceScene scene = roomWithSphere(40);
    const Bvh bvh = buildBvh(scene.mesh);
    checkTree(scene.mesh, bvh);
    EXPECT_LT(bvh.depth, 30u);
}

TEST(Bvh, oneTriangle) {
    const WorldMesh mesh = meshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const Bvh bvh = buildBvh(mesh);
    checkTree(mesh, bvh, 2); // the root has its leaf on both sides
    BvhWalk walk{&bvh};
    EXPECT_EQ(walk.bvhClosestHit({0.2f, 0.2f, 1}, {0, 0, -1}, 0, 1e30f).triangle, 0u);
    EXPECT_EQ(walk.bvhClosestHit({0.8f, 0.8f, 1}, {0, 0, -1}, 0, 1e30f).triangle, shader::kNoPatch);
}

TEST(Bvh, manyTrianglesInOnePlaceStayWithinTheStack) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 5000; ++i)
        corners.insert(corners.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const WorldMesh mesh = meshOf(corners);
    const Bvh bvh = buildBvh(mesh);
    checkTree(mesh, bvh);
    BvhWalk walk{&bvh};
    EXPECT_EQ(walk.bvhClosestHit({0.2f, 0.2f, 1}, {0, 0, -1}, 0, 1e30f).triangle, 0u)
        << "the lowest index of equals";
}

// Sizes growing geometrically drive the area heuristic to cut off one triangle at a time.
TEST(Bvh, lopsidedScenesStayWithinTheStack) {
    std::vector<glm::vec3> corners;
    float x = 1e-15f;
    for (int i = 0; i < 300; ++i, x *= 1.25f)
        corners.insert(corners.end(), {{x, 0, 0}, {x, x, 0}, {x, 0, x}});
    const WorldMesh mesh = meshOf(corners);
    const Bvh bvh = buildBvh(mesh);
    EXPECT_LE(bvh.depth, shader::kBvhDepth);
    EXPECT_EQ(bvh.triangles.size(), 300u);
}

TEST(Bvh, isTheSameEveryTime) {
    const TraceScene scene = roomWithSphere(120); // large enough for several threads
    const Bvh a = buildBvh(scene.mesh), b = buildBvh(scene.mesh);
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BvhNode)), 0);
    EXPECT_EQ(
        std::memcmp(a.triangles.data(), b.triangles.data(), a.triangles.size() * sizeof(shader::BvhTriangle)),
        0);
}

TEST(Bvh, splitsByTheAreaHeuristic) {
    const TraceScene scene = roomWithSphere(40);
    const Bvh bvh = buildBvh(scene.mesh);
    // A median tree of this scene costs about twice as much.
    EXPECT_LT(bvhCost(bvh), 40.0);
}

TEST(Bvh, findsWhatBruteForceFinds) {
    const TraceScene scene = roomWithSphere(24);
    const Bvh bvh = buildBvh(scene.mesh);
    BvhWalk walk{&bvh};
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    uint32_t hits = 0;
    uint32_t blocker = walk.kNoBlocker;
    for (int i = 0; i < 5000; ++i) {
        const glm::vec3 origin = glm::vec3(4, 3, 5) * glm::vec3(unit(random), unit(random), unit(random));
        glm::vec3 direction(unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f);
        if (i % 8 == 0) direction[i / 8 % 3] = 0; // parallel to a wall
        if (i % 16 == 0) direction[(i / 8 + 1) % 3] = -0.0f;
        const float tMin = i % 3 == 0 ? 0.5f : 0.0f, tMax = i % 2 == 0 ? 3.0f : 1e30f;
        const auto found = walk.bvhClosestHit(origin, direction, tMin, tMax);
        const auto expected = walk.bruteForce(origin, direction, tMin, tMax);
        ASSERT_EQ(found.triangle, expected.triangle) << i;
        ASSERT_EQ(walk.bvhAnyHit(origin, direction, tMin, tMax, blocker),
                  expected.triangle != shader::kNoPatch)
            << i;
        if (found.triangle == shader::kNoPatch) continue;
        ++hits;
        ASSERT_EQ(found.t, expected.t);
        ASSERT_TRUE(found.t >= tMin && found.t <= tMax);
        const glm::vec3* p = &scene.mesh.positions[found.triangle * 3];
        const glm::vec3 on = p[0] * (1 - found.b1 - found.b2) + p[1] * found.b1 + p[2] * found.b2;
        ASSERT_LT(glm::length(origin + found.t * direction - on), 1e-4f) << i;
    }
    EXPECT_GT(hits, 2000u);
}

// Compares both walks with brute force, for one ray and the one the other way.
void expectAgreement(BvhWalk& walk, glm::vec3 origin, glm::vec3 direction, const std::string& what) {
    for (const glm::vec3 d : {direction, -direction}) {
        const auto expected = walk.bruteForce(origin, d, 0, 1e30f);
        const auto found = walk.bvhClosestHit(origin, d, 0, 1e30f);
        uint32_t blocker = walk.kNoBlocker;
        ASSERT_EQ(found.triangle, expected.triangle) << what;
        ASSERT_EQ(found.t, expected.t) << what;
        ASSERT_EQ(walk.bvhAnyHit(origin, d, 0, 1e30f, blocker), expected.triangle != shader::kNoPatch)
            << what;
    }
}

// Rays go from corners, edges and faces of boxes, along the axes, along the faces and to other boxes'
// corners.
TEST(Bvh, findsWhatBruteForceFindsFromItsBoxes) {
    const TraceScene scene = roomWithSphere(12);
    const Bvh bvh = buildBvh(scene.mesh);
    BvhWalk walk{&bvh};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto pointOf = [&](bool corner) {
        const BvhBox box = childBox(bvh.nodes[random() % bvh.nodes.size()], int(random() % 2));
        glm::vec3 p;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = glm::mix(box.lo[axis], box.hi[axis], corner ? float(random() % 2) : unit(random));
        const int face = int(random() % 3);
        p[face] = random() % 2 == 0 ? box.lo[face] : box.hi[face];
        return p;
    };
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 origin = pointOf(i % 2 == 0);
        glm::vec3 direction = pointOf(i % 4 < 2) - origin;
        if (i % 3 == 0) direction[int(random() % 3)] = i % 2 == 0 ? 0.0f : -0.0f;
        if (i % 5 == 0) direction = glm::vec3(i % 15 == 0, i % 15 == 5, i % 15 == 10);
        if (glm::length(direction) > 0) expectAgreement(walk, origin, direction, std::to_string(i));
    }
}

// Triangles without area (points, lines, double corners) are among others: they stop nothing and hide
// nothing.
TEST(Bvh, degenerateTrianglesAreHarmless) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 p = point(), q = p + 0.2f * point(), r = p + 0.2f * point();
        if (i % 4 == 0) corners.insert(corners.end(), {p, p, p});
        if (i % 4 == 1) corners.insert(corners.end(), {p, q, q});
        if (i % 4 == 2) corners.insert(corners.end(), {p, 0.5f * (p + q), q});
        if (i % 4 == 3) corners.insert(corners.end(), {p, q, r});
    }
    const WorldMesh mesh = meshOf(corners);
    const Bvh bvh = buildBvh(mesh);
    checkTree(mesh, bvh);
    BvhWalk walk{&bvh};
    for (int i = 0; i < 4000; ++i) {
        const glm::vec3 aim = i % 2 == 0 ? point() : corners[random() % corners.size()];
        const glm::vec3 origin = point();
        expectAgreement(walk, origin, aim - origin, std::to_string(i));
    }
    const WorldMesh points = meshOf(std::vector<glm::vec3>(30, glm::vec3(1)));
    const Bvh flat = buildBvh(points); // all boxes without area
    checkTree(points, flat);
    BvhWalk through{&flat};
    EXPECT_EQ(through.bvhClosestHit(glm::vec3(0), glm::vec3(1), 0, 1e30f).triangle, shader::kNoPatch);
}

// The tree is as deep as is allowed, with something on the stack at every level: nodes in a row whose boxes
// hold the ray.
TEST(Bvh, theStackHoldsTheDeepestTree) {
    Bvh bvh;
    bvh.depth = shader::kBvhDepth;
    for (uint32_t i = 0; i <= bvh.depth; ++i) // the last one is the nearest
        bvh.triangles.push_back(
            {{-9, -9, -float(i)}, bvh.depth - i, {9, -9, -float(i)}, 0, {0, 9, -float(i)}, 0});
    for (uint32_t i = 0; i < bvh.depth; ++i) {
        BvhNode node{};
        node.extents = glm::uvec3(0x42c842c8u); // 100 m
        node.child1 = ~int(i << 3 | 1u);
        node.child0 = i + 1 < bvh.depth ? int(i + 1) : ~int((i + 1) << 3 | 1u);
        bvh.nodes.push_back(node);
    }
    BvhWalk walk{&bvh};
    expectAgreement(walk, {0, 0, -60}, {0, 0, 1}, "from the last");
    expectAgreement(walk, {0, 0, 1}, {0, 0, -1}, "from the first");
    EXPECT_EQ(walk.bvhClosestHit({0, 0, -60}, {0, 0, 1}, 0, 1e30f).triangle, 0u);
}

// A ray from the very plane of what it hits ends there, at 0 or -0: it does not go through all that lies
// behind it.
TEST(Bvh, raysThatEndWhereTheyBeginSeeLittleOfTheTree) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    std::vector<glm::vec3> corners = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    for (int i = 0; i < 4000; ++i) {
        const glm::vec3 p = point();
        corners.insert(corners.end(), {p, p + 0.03f * point(), p + 0.03f * point()});
    }
    const WorldMesh mesh = meshOf(corners);
    const Bvh bvh = buildBvh(mesh);
    BvhWalk walk{&bvh};
    for (int i = 0; i < 200; ++i) {
        walk.visits = 0;
        const glm::vec3 origin(unit(random), unit(random), 0);
        const auto found = walk.bvhClosestHit(origin, {0.1f, 0.2f, i % 2 == 0 ? 1 : -1}, 0, 1e30f);
        EXPECT_EQ(found.triangle, 0u);
        EXPECT_EQ(found.t, 0.0f);
        EXPECT_LT(walk.visits, 200u);
    }
}

// From inside a closed room every ray hits something, wherever it goes: here straight at vertices and edges.
TEST(Bvh, leaksNowhere) {
    for (const auto& [scale, shift] : {std::pair(1.0f, 0.0f), std::pair(0.01f, 0.0f),
                                       std::pair(1000.0f, 0.0f), std::pair(1.0f, 1000.0f)}) {
        TraceScene scene = roomWithSphere(30);
        for (glm::vec3& p : scene.mesh.positions)
            p = p * scale + shift;
        const Bvh bvh = buildBvh(scene.mesh);
        BvhWalk walk{&bvh};
        std::mt19937 random(7);
        std::uniform_real_distribution<float> unit(0, 1);
        for (int i = 0; i < 20000; ++i) {
            const size_t triangle = random() % scene.mesh.triangleCount();
            const glm::vec3 a = scene.mesh.positions[triangle * 3 + random() % 3];
            const glm::vec3 b = scene.mesh.positions[triangle * 3 + random() % 3];
            const float s = i % 2 == 0 ? 0.0f : unit(random);
            const glm::vec3 origin = glm::vec3(0.3f, 2.5f, 4.0f + unit(random)) * scale + shift;
            const glm::vec3 direction = a + (b - a) * s - origin;
            ASSERT_NE(walk.bvhClosestHit(origin, direction, 0, 1e30f).triangle, shader::kNoPatch)
                << i << ", scale " << scale;
        }
    }
}

TEST(Bvh, raysFromASurfaceDoNotHitIt) {
    const TraceScene scene = roomWithSphere(24);
    const Bvh bvh = buildBvh(scene.mesh);
    BvhWalk walk{&bvh};
    for (size_t i = 0; i < 6 * 512; i += 7) { // the walls
        const shader::Patch& patch = scene.patches[i];
        for (uint32_t k = 0; k < 4; ++k) {
            const glm::vec3 direction =
                shader::patchDirection(patch, shader::keyAlone(shader::seedKey(patch)), k);
            const auto found =
                walk.bvhClosestHit(patch.position + patch.offset * patch.normal, direction, 0, 1e30f);
            ASSERT_NE(found.triangle, shader::kNoPatch);
            EXPECT_NE(scene.hitTriangles[found.triangle].normal, patch.normal);
        }
    }
}

TEST(Bvh, maskedTrianglesAskForSolidity) {
    WorldMesh mesh = meshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    mesh.opaqueCount = 1;
    const Bvh bvh = buildBvh(mesh);
    float asked1 = -1, asked2 = -1;
    bool solid = false;
    BvhWalk walk{&bvh, [&](uint32_t id, float b1, float b2) {
                     EXPECT_EQ(id, 1u);
                     asked1 = b1, asked2 = b2;
                     return solid;
                 }};
    const glm::vec3 origin(0.25f, 0.5f, 2), down(0, 0, -1);
    EXPECT_EQ(walk.bvhClosestHit(origin, down, 0, 1e30f).triangle, 0u);
    EXPECT_FLOAT_EQ(asked1, 0.25f);
    EXPECT_FLOAT_EQ(asked2, 0.5f);
    uint32_t blocker = walk.kNoBlocker;
    EXPECT_FALSE(walk.bvhAnyHit(origin, down, 0, 1.5f, blocker));
    solid = true;
    EXPECT_EQ(walk.bvhClosestHit(origin, down, 0, 1e30f).triangle, 1u);
    EXPECT_TRUE(walk.bvhAnyHit(origin, down, 0, 1.5f, blocker));
}

} // namespace
} // namespace relume
