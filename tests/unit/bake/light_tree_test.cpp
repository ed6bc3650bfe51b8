#include "bake/lights/light_tree.h"

#include "tests/unit/emitter_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

namespace relume {
namespace {

using shader::EmitterNode;
using shader::EmitterPolygon;

struct Receiver {
    glm::vec3 position, normal;
};

std::vector<Receiver> receivers(uint32_t count, float reach = 1.0f) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::vector<Receiver> list;
    while (list.size() < count) {
        const glm::vec3 n = 2.0f * glm::vec3(unit(random), unit(random), unit(random)) - 1.0f;
        const glm::vec3 p(unit(random), unit(random), unit(random));
        if (glm::length(n) > 0.1f) list.push_back({0.5f + reach * (p - 0.5f), glm::normalize(n)});
    }
    return list;
}

// Finds the chance of every mesh light by going down both ways; returns that of ending at none.
double chances(const EmitterSet& set, const Receiver& r, uint32_t index, double chance,
               std::vector<double>& out) {
    const EmitterNode& node = set.nodes[index];
    if ((node.link & shader::kEmitterLeaf) != 0) {
        out[node.link & ~shader::kEmitterLeaf] += chance;
        return 0;
    }
    const float share =
        shader::shareOfFirst(shader::emitterImportance(set.nodes[node.link], r.position, r.normal),
                             shader::emitterImportance(set.nodes[node.link + 1], r.position, r.normal));
    if (share < 0) return chance;
    double none = 0;
    if (share > 0) none += chances(set, r, node.link, chance * share, out);
    if (share < 1) none += chances(set, r, node.link + 1, chance * (1.0 - share), out);
    return none;
}

double lightOf(const EmitterPolygon& e, const Receiver& r) {
    return shader::emitterFormFactor(r.position, r.normal, e) * (e.radiance.r + e.radiance.g + e.radiance.b) /
           3.0;
}

uint32_t depthOf(const std::vector<EmitterNode>& nodes, uint32_t index = 0) {
    if ((nodes[index].link & shader::kEmitterLeaf) != 0) return 0;
    return 1 + std::max(depthOf(nodes, nodes[index].link), depthOf(nodes, nodes[index].link + 1));
}

float stratified(uint32_t i, uint32_t count) {
    return (float(i) + 0.5f) / float(count);
}

} // namespace

TEST(LightTree, HoldsEveryPolygonOnceWithinItsNode) {
    const EmitterSet set = test::emittersOf(test::manyLamps(1000, 0.05f));
    EXPECT_EQ(set.nodes.size(), 2 * set.polygons.size() - 1);
    EXPECT_NEAR(set.nodes[0].power, 1.0f, 1e-6f);
    std::vector<int> seen(set.polygons.size(), 0);
    for (const EmitterNode& node : set.nodes) {
        if ((node.link & shader::kEmitterLeaf) != 0) {
            ++seen[node.link & ~shader::kEmitterLeaf];
            continue;
        }
        const EmitterNode &a = set.nodes[node.link], &b = set.nodes[node.link + 1];
        EXPECT_NEAR(node.power, a.power + b.power, 1e-5f * node.power);
        EXPECT_EQ(node.lo, glm::min(a.lo, b.lo));
        EXPECT_EQ(node.hi, glm::max(a.hi, b.hi));
    }
    for (int count : seen)
        EXPECT_EQ(count, 1);
}

TEST(LightTree, ConesHoldAllNormalsBelow) {
    const EmitterSet set = test::emittersOf(test::glowing(test::sphere(24)));
    const auto check = [&](const auto& self, uint32_t root, uint32_t index) -> void {
        const EmitterNode &top = set.nodes[root], &node = set.nodes[index];
        if ((node.link & shader::kEmitterLeaf) != 0) {
            const glm::vec3 n = shader::emitterNormal(set.polygons[node.link & ~shader::kEmitterLeaf]);
            EXPECT_GE(glm::dot(n, top.axis), top.cosCone - 1e-6f);
            return;
        }
        self(self, root, node.link);
        self(self, root, node.link + 1);
    };
    uint32_t narrow = 0;
    for (uint32_t i = 0; i < set.nodes.size(); ++i) {
        check(check, i, i);
        narrow += set.nodes[i].cosCone > 0.5f;
    }
    EXPECT_GT(narrow, set.nodes.size() * 9 / 10);
}

TEST(LightTree, ChancesSumToOneAndAreWhatIsPicked) {
    for (const uint32_t count : {1u, 2u, 10u, 100u}) {
        const EmitterSet set = test::emittersOf(test::manyLamps(count, 0.1f));
        shader::EmitterTables tables{&set};
        for (const Receiver& r : receivers(10)) {
            if (shader::emitterImportance(set.nodes[0], r.position, r.normal) == 0) continue;
            std::vector<double> chance(set.polygons.size()), found(set.polygons.size());
            const double none = chances(set, r, 0, 1.0, chance);
            double sum = none;
            for (double c : chance)
                sum += c;
            EXPECT_NEAR(sum, 1, 1e-5);
            constexpr uint32_t picks = 100'000;
            double foundNone = 0;
            for (uint32_t i = 0; i < picks; ++i) {
                float probability = 0;
                const uint32_t e =
                    tables.pickEmitter(r.position, r.normal, stratified(i, picks), probability);
                if (e == shader::kNoEmitter) {
                    EXPECT_EQ(probability, 0.0f);
                    foundNone += 1.0 / picks;
                } else {
                    EXPECT_NEAR(probability, chance[e], 1e-4 * chance[e]);
                    found[e] += 1.0 / picks;
                }
            }
            EXPECT_NEAR(foundNone, none, 1e-4);
            for (size_t e = 0; e < chance.size(); ++e) // one number, rescaled, is as even as the first one
                EXPECT_NEAR(found[e], chance[e], 5e-5 + 1e-3 * chance[e]);
        }
    }
}

// Every mesh light that lights the receiver at all has a chance, and the mean of light / chance is all light.
TEST(LightTree, EstimatesAreUnbiasedHoweverManyEmitters) {
    for (const uint32_t count : {1u, 10u, 1000u}) {
        const EmitterSet set = test::emittersOf(test::manyLamps(count, count > 100 ? 0.02f : 0.2f));
        shader::EmitterTables tables{&set};
        for (const Receiver& r : receivers(20)) {
            std::vector<double> chance(set.polygons.size());
            if (shader::emitterImportance(set.nodes[0], r.position, r.normal) > 0)
                chances(set, r, 0, 1.0, chance);
            double exact = 0;
            for (size_t e = 0; e < set.polygons.size(); ++e) {
                const double light = lightOf(set.polygons[e], r);
                exact += light;
                EXPECT_TRUE(light == 0 || chance[e] > 0) << e;
            }
            constexpr uint32_t picks = 1u << 16;
            double sum = 0;
            for (uint32_t i = 0; i < picks; ++i) {
                float probability = 0;
                const uint32_t e =
                    tables.pickEmitter(r.position, r.normal, stratified(i, picks), probability);
                if (e != shader::kNoEmitter) sum += lightOf(set.polygons[e], r) / probability;
            }
            EXPECT_NEAR(sum / picks, exact, 5e-3 * exact) << count;
        }
    }
}

TEST(LightTree, NoiseOfOnePickIsModest) {
    const EmitterSet set = test::emittersOf(test::manyLamps(1000, 0.01f));
    double relative = 0, uniform = 0;
    const std::vector<Receiver> list = receivers(200);
    for (const Receiver& r : list) {
        std::vector<double> chance(set.polygons.size());
        chances(set, r, 0, 1.0, chance);
        double exact = 0, square = 0, flat = 0;
        for (size_t e = 0; e < set.polygons.size(); ++e) {
            const double light = lightOf(set.polygons[e], r);
            exact += light;
            if (light > 0) square += light * light / chance[e];
            flat += light * light * double(set.polygons.size());
        }
        if (exact == 0) continue; // it faces away from all of them
        relative += (square / (exact * exact) - 1) / double(list.size());
        uniform += (flat / (exact * exact) - 1) / double(list.size());
    }
    RecordProperty("relativeVariance", std::to_string(relative));
    EXPECT_LT(relative, uniform / 10);
    EXPECT_LT(relative, 8); // 4.2
}

// A plate beside a finely cut lamp, and another lamp farther off. Picks from the root on find the few
// polygons that the plate is close to too rarely: what they bring then is off by a hundred. The mean is that
// of all polygons, over all starts, however it is picked.
TEST(LightTree, BesideALampPicksAreRightAndTheirNoiseIsModest) {
    Scene scene = test::glowing(test::sphere(48));
    test::addInstance(scene, 0, glm::translate(glm::mat4(1), glm::vec3(0, 6, 0)));
    const EmitterSet set = test::emittersOf(scene);
    ASSERT_GT(set.polygons.size(), 2000u);
    shader::EmitterTables tables{&set};
    constexpr float kTexel = 0.05f, kGap = 0.004f; // [m]; the lamp's radius is 1 m
    constexpr uint32_t kPicks = 1u << 12;
    double plain = 0, near = 0;
    for (uint32_t place = 0; place < 12; ++place) {
        const float turn = 0.5f * static_cast<float>(place) + 0.1f;
        const glm::vec3 out = glm::normalize(glm::vec3(std::cos(turn), 0.3f, std::sin(turn)));
        const glm::vec3 along = glm::normalize(glm::cross(out, glm::vec3(0, 1, 0)));
        // It stands on end: it sees the lamp beside it at a slant.
        const glm::vec3 normal = glm::normalize(glm::cross(out, along));
        const Receiver middle{out * (1.0f + kGap + 0.5f * kTexel), normal};
        ASSERT_TRUE(tables.hasNearEmitter(middle.position, kTexel)) << place;
        shader::EmitterTables::PickView view = tables.pointView(middle.position, middle.normal);
        view.near = kTexel;
        view.count = shader::kPickStarts;
        double exact = 0;
        std::vector<double> lights(set.polygons.size(), 0.0);
        for (uint32_t s = 0; s < view.count; ++s) {
            const float share = (static_cast<float>(s) + 0.5f) / static_cast<float>(view.count);
            view.starts[s] = out * (1.0f + kGap + share * kTexel);
            for (size_t e = 0; e < lights.size(); ++e)
                lights[e] += lightOf(set.polygons[e], {view.starts[s], normal}) / view.count;
        }
        for (const double light : lights)
            exact += light;
        ASSERT_GT(exact, 0.0);
        double sum = 0, squares = 0, plainSquares = 0;
        for (uint32_t i = 0; i < kPicks; ++i) {
            float probability = 0;
            const uint32_t e = tables.pickNearEmitter(view, stratified(i, kPicks), probability);
            if (e != shader::kNoEmitter) {
                sum += lights[e] / probability / kPicks;
                squares += lights[e] * lights[e] / probability / probability / kPicks;
            }
            const uint32_t other =
                tables.pickEmitter(middle.position, normal, stratified(i, kPicks), probability);
            if (other != shader::kNoEmitter)
                plainSquares += lights[other] * lights[other] / probability / probability / kPicks;
        }
        EXPECT_NEAR(sum / exact, 1.0, 0.04) << place;
        near += squares / (exact * exact) - 1;
        plain += plainSquares / (exact * exact) - 1;
    }
    RecordProperty("relativeVariance",
                   std::to_string(near / 12) + " in place of " + std::to_string(plain / 12));
    EXPECT_LT(near, 0.4 * plain) << near / 12 << " in place of " << plain / 12;
    EXPECT_LT(near / 12, 2.5);
}

TEST(LightTree, FarFromAllLampsNoneIsNear) {
    const EmitterSet set = test::emittersOf(test::glowing(test::sphere(24)));
    shader::EmitterTables tables{&set};
    EXPECT_FALSE(tables.hasNearEmitter({0, 2, 0}, 0.5f));
    EXPECT_TRUE(tables.hasNearEmitter({0, 1.4f, 0}, 0.5f));
}

TEST(LightTree, ATinyLampBesideAHugeOneIsFound) {
    Scene scene = test::glowing(test::square(), glm::vec3(1));
    scene.instances[0].transform =
        glm::scale(glm::translate(glm::mat4(1), glm::vec3(-50, -50, -100)), glm::vec3(100));
    Primitive lamp = test::square();
    lamp.material = 0;
    test::addInstance(scene, test::addMesh(scene, lamp),
                      glm::scale(glm::translate(glm::mat4(1), glm::vec3(0, 0, -1e-3f)), glm::vec3(1e-3f)));
    const EmitterSet set = test::emittersOf(scene);
    ASSERT_EQ(set.polygons.size(), 2u); // 1e10 times the power
    shader::EmitterTables tables{&set};
    const Receiver r{{5e-4f, 5e-4f, 0}, {0, 0, -1}};
    const double exact = lightOf(set.polygons[0], r) + lightOf(set.polygons[1], r);
    double sum = 0;
    for (uint32_t i = 0; i < 64; ++i) {
        float probability = 0;
        const uint32_t e = tables.pickEmitter(r.position, r.normal, stratified(i, 64), probability);
        ASSERT_NE(e, shader::kNoEmitter);
        sum += lightOf(set.polygons[e], r) / probability;
    }
    EXPECT_NEAR(sum / 64, exact, 0.05 * exact);
}

TEST(LightTree, WhatIsBelowTheHorizonOrTurnedAwayGetsNothing) {
    const EmitterSet set = test::emittersOf(test::glowing(test::square()));
    const EmitterNode& root = set.nodes[0];
    EXPECT_GT(shader::emitterImportance(root, {0.5f, 0.5f, 1}, {0, 0, -1}), 0.0f);
    EXPECT_EQ(shader::emitterImportance(root, {0.5f, 0.5f, 1}, {0, 0, 1}), 0.0f);
    EXPECT_EQ(shader::emitterImportance(root, {0.5f, 0.5f, -1}, {0, 0, 1}), 0.0f);
    shader::EmitterTables tables{&set};
    float probability = 1;
    EXPECT_EQ(tables.pickEmitter({0.5f, 0.5f, -1}, {0, 0, 1}, 0.5f, probability), shader::kNoEmitter);
    EXPECT_EQ(probability, 0.0f);
}

TEST(LightTree, WithoutEmittersEveryPickEndsAtTheRoot) {
    const EmitterSet set = test::emittersOf(test::sceneOf(test::square()));
    EXPECT_TRUE(set.polygons.empty());
    EXPECT_EQ(set.power, 0.0);
    ASSERT_EQ(set.nodes.size(), 1u);
    shader::EmitterTables tables{&set};
    float probability = 1;
    EXPECT_EQ(tables.pickEmitter({0, 0, 1}, {0, 0, -1}, 0.5f, probability), shader::kNoEmitter);
    EXPECT_EQ(probability, 0.0f);
}

// Many mesh lights in one place and of ever smaller size make trees deep.
TEST(LightTree, DepthIsBounded) {
    std::vector<EmitterPolygon> polygons;
    for (uint32_t i = 0; i < 3000; ++i) {
        const float x = i < 1000 ? std::ldexp(1.0f, -int(i % 100)) : 0.0f, s = 1e-6f;
        EmitterPolygon e{};
        e.c0 = {x, 0, 0}, e.c1 = {x + s, 0, 0}, e.c2 = {x + s, s, 0}, e.c3 = {x, s, 0};
        e.area = s * s, e.radiance = glm::vec3(1), e.shape = shader::kEmitterParallelogram;
        polygons.push_back(e);
    }
    const std::vector<EmitterNode> nodes = buildLightTree(polygons);
    EXPECT_LE(depthOf(nodes), shader::kEmitterDepth);
    EXPECT_EQ(nodes.size(), 2 * polygons.size() - 1);
}

// A scene scaled by 1000 or 0.01 is sampled alike.
TEST(LightTree, ScaleDoesNotMatter) {
    Scene scene = test::manyLamps(50, 0.1f);
    const EmitterSet set = test::emittersOf(scene);
    for (const float scale : {0.01f, 1000.0f}) {
        Scene other = scene;
        for (Instance& instance : other.instances)
            instance.transform = glm::scale(glm::mat4(1), glm::vec3(scale)) * instance.transform;
        const EmitterSet scaled = test::emittersOf(other);
        ASSERT_EQ(scaled.polygons.size(), set.polygons.size());
        for (const Receiver& r : receivers(20)) {
            std::vector<double> here(set.polygons.size()), there(set.polygons.size());
            chances(set, r, 0, 1.0, here);
            chances(scaled, {scale * r.position, r.normal}, 0, 1.0, there);
            for (size_t e = 0; e < here.size(); ++e)
                EXPECT_NEAR(here[e], there[e], 1e-3);
        }
    }
}

// The tree makes the time of a pick grow with the logarithm of the number of lamps. Both are timed in turns
// in one run, for machines differ and may be busy: a hundred times as many lamps take far less than a hundred
// times as long.
TEST(LightTree, PickingAmongManyCostsLittleMoreThanAmongFew) {
    const std::vector<Receiver> list = receivers(1000);
    float sum = 0;
    const auto seconds = [&](shader::EmitterTables& tables) {
        const std::clock_t start = std::clock(); // the processor's time
        for (uint32_t i = 0; i < 20'000; ++i) {
            float probability = 0;
            const Receiver& r = list[i / 20]; // a patch takes some samples at a time
            sum += float(tables.pickEmitter(r.position, r.normal, stratified(i % 20, 20), probability));
        }
        return double(std::clock() - start) / CLOCKS_PER_SEC;
    };
    const EmitterSet few = test::emittersOf(test::manyLamps(100, 0.005f));
    const EmitterSet many = test::emittersOf(test::manyLamps(10'000, 0.005f));
    shader::EmitterTables fewTables{&few}, manyTables{&many};
    double bestOfFew = 1e9, bestOfMany = 1e9;
    for (int turn = 0; turn < 5; ++turn) {
        bestOfFew = std::min(bestOfFew, seconds(fewTables));
        bestOfMany = std::min(bestOfMany, seconds(manyTables));
    }
    EXPECT_GT(sum, 0);
    RecordProperty("nanoseconds", std::to_string(1e9 * bestOfMany / 20'000));
    EXPECT_LT(bestOfMany, 20 * bestOfFew);
}

} // namespace relume
