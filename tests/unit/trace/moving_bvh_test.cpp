// Trees whose triangles move are held against trees built anew.
#include "bake/trace/moving_bvh.h"
#include "bake/trace/tree_ahead.h"

#include <cstring>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/unit/bvh_walk.h"

namespace relume {
namespace {

using shader::BvhNode;
using shader::BvhWalk;

/// Holds a room with a sphere and clutter: each object is a run of triangles.
class Stage {
public:
    explicit Stage(uint32_t seed = 1) : random_(seed), mesh(roomWithSphere(12).mesh) {
        const auto sphere = uint32_t(mesh.triangleCount());
        for (int i = 0; i < 60; ++i) {
            const glm::vec3 at = glm::vec3(4, 3, 5) * point();
            const auto first = mesh.triangleCount();
            for (int k = 0; k < 1 + i % 9; ++k)
                for (int corner = 0; corner < 3; ++corner)
                    mesh.positions.push_back(at + 0.5f * point());
            mesh.material.resize(mesh.positions.size() / 3, 0);
            objects.push_back(run(first, mesh.triangleCount()));
        }
        mesh.opaqueCount = mesh.triangleCount() - 7; // the last ones are masked
        objects.push_back(run(sphere - 2 * 12 * 12, sphere));
    }

    glm::vec3 point() { return {unit_(random_), unit_(random_), unit_(random_)}; }
    uint32_t number(size_t below) { return uint32_t(random_() % below); }
    const std::vector<uint32_t>& anObject() { return objects[number(objects.size())]; }
    void shift(const std::vector<uint32_t>& object, glm::vec3 way) {
        for (const uint32_t t : object)
            for (uint32_t k = 0; k < 3; ++k)
                mesh.positions[size_t{t} * 3 + k] += way;
    }

private:
    static std::vector<uint32_t> run(uint32_t first, uint32_t last) {
        std::vector<uint32_t> triangles(last - first);
        std::iota(triangles.begin(), triangles.end(), first);
        return triangles;
    }
    std::mt19937 random_;
    std::uniform_real_distribution<float> unit_{0, 1};

public:
    WorldMesh mesh;
    std::vector<std::vector<uint32_t>> objects;
};

// Walks the tree: every node is met once, boxes hold what is below them, and each triangle as it stands now
// is in one leaf.
void checkTree(const WorldMesh& mesh, const Bvh& bvh, bool whole) {
    std::vector<uint32_t> met(mesh.triangleCount(), 0), nodes(bvh.nodes.size(), 0);
    const std::function<uint32_t(int, BvhBox)> visit = [&](int child, const BvhBox& box) -> uint32_t {
        if (child >= 0) {
            const BvhNode& node = bvh.nodes.at(size_t(child));
            ++nodes[size_t(child)];
            uint32_t depth = 0;
            for (int side = 0; side < 2; ++side) {
                const BvhBox own = childBox(node, side);
                depth = std::max(depth, visit(side == 0 ? node.child0 : node.child1,
                                              {glm::max(box.lo, own.lo), glm::min(box.hi, own.hi)}));
            }
            return depth + 1;
        }
        const uint32_t first = uint32_t(~child) >> 3, count = uint32_t(~child) & 7;
        EXPECT_TRUE(count <= 4);
        for (uint32_t i = first; i < first + count; ++i) {
            const shader::BvhTriangle& triangle = bvh.triangles.at(i);
            const uint32_t id = triangle.id & 0x7fffffffu;
            EXPECT_EQ(triangle.id != id, id >= mesh.opaqueCount);
            ++met.at(id);
            const glm::vec3* corner = &mesh.positions[size_t{id} * 3];
            for (const glm::vec3& p : {triangle.p0, triangle.p1, triangle.p2}) {
                EXPECT_EQ(p, *corner++);
                EXPECT_TRUE(glm::all(glm::greaterThan(p, box.lo)) && glm::all(glm::lessThan(p, box.hi)));
            }
        }
        return 0;
    };
    EXPECT_EQ(visit(0, {glm::vec3(-1e30f), glm::vec3(1e30f)}), bvh.depth);
    EXPECT_LE(bvh.depth, shader::kBvhDepth);
    for (const uint32_t count : nodes)
        EXPECT_EQ(count, 1u);
    for (uint32_t t = 0; t < met.size(); ++t) {
        const glm::vec3* p = &mesh.positions[size_t{t} * 3];
        const bool point = p[0] == p[1] && p[0] == p[2]; // may be left out
        EXPECT_TRUE(met[t] == 1 || (point && !whole && met[t] == 0)) << t;
    }
}

// Expects closest and any hits of random rays as a tree built anew has them.
void expectHitsOf(Stage& stage, const Bvh& bvh, int rays) {
    const Bvh anew = buildBvh(stage.mesh);
    const auto solid = [](uint32_t, float b1, float b2) { return b1 < 0.3f || b2 > 0.4f; };
    BvhWalk walk{&bvh, solid}, fresh{&anew, solid};
    uint32_t blocker = walk.kNoBlocker, freshBlocker = walk.kNoBlocker;
    for (int i = 0; i < rays; ++i) {
        const glm::vec3 origin = glm::vec3(4, 3, 5) * stage.point();
        glm::vec3 direction = stage.point() - 0.5f;
        if (i % 2 == 0) direction = stage.mesh.positions[stage.number(stage.mesh.positions.size())] - origin;
        if (i % 7 == 0) direction[i / 7 % 3] = 0;
        if (direction == glm::vec3(0)) continue;
        const auto found = walk.bvhClosestHit(origin, direction, 0, 1e30f);
        const auto wanted = fresh.bvhClosestHit(origin, direction, 0, 1e30f);
        ASSERT_EQ(found.triangle, wanted.triangle) << i;
        ASSERT_EQ(found.t, wanted.t) << i;
        const float most = i % 3 == 0 ? 1.0f : 1e30f;
        ASSERT_EQ(walk.bvhAnyHit(origin, direction, 0, most, blocker),
                  fresh.bvhAnyHit(origin, direction, 0, most, freshBlocker))
            << i;
    }
}

/// Holds what a device that is told of changes only would hold.
class Copy {
public:
    explicit Copy(const Bvh& bvh) : bvh_(bvh) {}
    void expectAfter(const Bvh& bvh, const MovingBvh::Change& change) {
        if (change.all) {
            EXPECT_TRUE(change.nodes.empty() && change.triangles.empty());
            bvh_ = bvh;
            return;
        }
        bvh_.nodes.resize(bvh.nodes.size());
        bvh_.triangles.resize(bvh.triangles.size());
        EXPECT_TRUE(std::is_sorted(change.nodes.begin(), change.nodes.end()));
        EXPECT_TRUE(std::is_sorted(change.triangles.begin(), change.triangles.end()));
        for (const uint32_t i : change.nodes)
            bvh_.nodes.at(i) = bvh.nodes[i];
        for (const uint32_t i : change.triangles)
            bvh_.triangles.at(i) = bvh.triangles[i];
        EXPECT_EQ(std::memcmp(bvh_.nodes.data(), bvh.nodes.data(), bvh.nodes.size() * sizeof(BvhNode)), 0);
        checkLeaves(bvh, 0);
    }

private:
    // Triangles that no leaf holds any more may be old ones.
    void checkLeaves(const Bvh& bvh, int child) {
        if (child >= 0) {
            checkLeaves(bvh, bvh.nodes[size_t(child)].child0);
            return checkLeaves(bvh, bvh.nodes[size_t(child)].child1);
        }
        const uint32_t first = uint32_t(~child) >> 3, count = uint32_t(~child) & 7;
        for (uint32_t i = first; i < first + count; ++i)
            EXPECT_EQ(std::memcmp(&bvh.triangles[i], &bvh_.triangles[i], sizeof(bvh.triangles[i])), 0);
    }
    Bvh bvh_;
};

} // namespace

TEST(MovingBvh, IsTheBuildersUntilSomethingMoves) {
    Stage stage;
    MovingBvh moving(stage.mesh);
    EXPECT_FALSE(moving.follow(stage.mesh, {}).all);
    const Bvh anew = buildBvh(stage.mesh);
    ASSERT_EQ(moving.bvh().nodes.size(), anew.nodes.size());
    EXPECT_EQ(std::memcmp(moving.bvh().nodes.data(), anew.nodes.data(), anew.nodes.size() * sizeof(BvhNode)),
              0);
}

TEST(MovingBvh, BuiltAheadItIsTheBuildersThoughTheMeshIsGone) {
    Stage stage;
    const Bvh wanted = buildBvh(stage.mesh);
    WorkerPool pool(2);
    TreeAhead ahead(stage.mesh, pool);
    stage.mesh = {};
    const MovingBvh tree = ahead.take();
    ASSERT_EQ(tree.bvh().nodes.size(), wanted.nodes.size());
    ASSERT_EQ(tree.bvh().triangles.size(), wanted.triangles.size());
    const auto same = [](const auto& a, const auto& b) {
        return std::memcmp(a.data(), b.data(), a.size() * sizeof(a.front())) == 0;
    };
    EXPECT_TRUE(same(tree.bvh().nodes, wanted.nodes));
    EXPECT_TRUE(same(tree.bvh().triangles, wanted.triangles));
}

TEST(MovingBvh, HitsWhatATreeBuiltAnewHitsAfterManyMoves) {
    Stage stage;
    MovingBvh moving(stage.mesh);
    Copy copy(moving.bvh());
    int joined = 0;
    for (int move = 0; move < 50; ++move) {
        const std::vector<uint32_t>& object = stage.anObject();
        stage.shift(object, stage.point() - 0.5f);
        const MovingBvh::Change change = moving.follow(stage.mesh, object);
        joined += !change.all;
        copy.expectAfter(moving.bvh(), change);
        checkTree(stage.mesh, moving.bvh(), change.all);
        expectHitsOf(stage, moving.bvh(), 300);
        if (HasFatalFailure()) FAIL() << "move " << move;
    }
    EXPECT_GT(joined, 30);
}

TEST(MovingBvh, AnObjectThatIsDraggedCostsItsOwnTree) {
    Stage stage;
    MovingBvh moving(stage.mesh);
    const std::vector<uint32_t>& object = stage.objects[8];
    for (int move = 0; move < 20; ++move) {
        stage.shift(object, {0.01f, 0.02f, 0.0f});
        const MovingBvh::Change change = moving.follow(stage.mesh, object);
        ASSERT_FALSE(change.all);
        // The first time, its leaves and what is above them change; later, its own tree and the node that
        // joins.
        EXPECT_LE(change.nodes.size(), move == 0 ? moving.bvh().nodes.size() / 4 : object.size() + 2);
        EXPECT_LE(change.triangles.size(), 2 * object.size());
    }
    EXPECT_LT(bvhCost(moving.bvh()), 1.2 * bvhCost(buildBvh(stage.mesh))) << "rays are hardly slower";
    expectHitsOf(stage, moving.bvh(), 2000);
}

TEST(MovingBvh, ThereAndBackIsWhatItWas) {
    Stage stage;
    MovingBvh moving(stage.mesh);
    const std::vector<glm::vec3> before = stage.mesh.positions;
    const std::set<uint32_t> touched = {3, 8, 20, 60};
    for (int round = 0; round < 3; ++round)
        for (const uint32_t i : touched) {
            stage.shift(stage.objects[i], stage.point() - 0.5f);
            moving.follow(stage.mesh, stage.objects[i]);
        }
    stage.mesh.positions = before;
    for (const uint32_t i : touched)
        moving.follow(stage.mesh, stage.objects[i]);
    checkTree(stage.mesh, moving.bvh(), false);
    expectHitsOf(stage, moving.bvh(), 3000);
}

// Hidden triangles are put into a point of something else.
TEST(MovingBvh, HiddenTrianglesTakeNoRoom) {
    Stage stage;
    MovingBvh moving(stage.mesh);
    for (const size_t i : {8u, 17u}) {
        for (const uint32_t t : stage.objects[i])
            std::fill_n(stage.mesh.positions.begin() + std::ptrdiff_t{t} * 3, 3, stage.mesh.positions[0]);
        EXPECT_FALSE(moving.follow(stage.mesh, stage.objects[i]).all);
        checkTree(stage.mesh, moving.bvh(), false);
        expectHitsOf(stage, moving.bvh(), 1000);
    }
    // Nothing is left of both but the node that joins nothing.
    const Bvh& bvh = moving.bvh();
    const BvhNode& root = bvh.nodes.front();
    EXPECT_TRUE(childBox(root, 1).empty());
    EXPECT_EQ(root.child1, ~0);
}

// The object gets coordinates that boxes leave no room for.
TEST(MovingBvh, AnObjectThatLeavesTheSceneIsFound) {
    Stage stage;
    MovingBvh moving(stage.mesh);
    int anew = 0;
    for (int move = 0; move < 12; ++move) {
        stage.shift(stage.objects[8], {0.0f, 0.0f, 1.0f});
        anew += moving.follow(stage.mesh, stage.objects[8]).all;
        checkTree(stage.mesh, moving.bvh(), false);
        expectHitsOf(stage, moving.bvh(), 500);
    }
    EXPECT_GT(anew, 0);
    EXPECT_LT(anew, 6) << "with room for what comes";
}

TEST(MovingBvh, MostOfASceneThatMovesIsBuiltAnew) {
    Stage stage;
    MovingBvh moving(stage.mesh);
    std::vector<uint32_t> most(stage.mesh.triangleCount() * 3 / 4);
    std::iota(most.begin(), most.end(), 0u);
    stage.shift(most, {-0.1f, 0.0f, 0.0f});
    EXPECT_TRUE(moving.follow(stage.mesh, most).all);
    expectHitsOf(stage, moving.bvh(), 1000);
    // Few triangles are a leaf, and there is nothing to take it apart for.
    Stage tiny;
    tiny.mesh.positions.resize(9);
    tiny.mesh.material.resize(3);
    tiny.mesh.opaqueCount = 3;
    MovingBvh small(tiny.mesh);
    tiny.shift({1}, {0.1f, 0.0f, 0.0f});
    small.follow(tiny.mesh, std::vector<uint32_t>{1});
    expectHitsOf(tiny, small.bvh(), 200);
}

} // namespace relume
