// This compares what all polygons of a mesh light bring without shadows as sums over edges and as sums of
// form factors.
#include "bake/direct/host_wholes.h"
#include "bake/lights/emitter_edges.h"
#include "tests/unit/emitter_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace relume {
namespace shader {
namespace {

struct WholeTables {
    const EmitterSet* set;
    std::vector<EmitterEdge> edges;
    EmitterNode emitterNode(uint index) { return set->nodes[index]; }
    EmitterPolygon emitterPolygon(uint index) { return set->polygons[index]; }
    EmitterEdge emitterEdge(uint index) { return edges[index]; }
#include "shaders/lib/light/whole_emitter.glsl"
};

} // namespace
} // namespace shader

namespace {

glm::vec3 sumOfFormFactors(const EmitterSet& set, const glm::vec3& p, const glm::vec3& n) {
    glm::dvec3 sum(0.0);
    for (const shader::EmitterPolygon& e : set.polygons)
        sum += glm::dvec3(e.radiance) * double{shader::emitterFormFactor(p, n, e)};
    return glm::vec3(sum);
}

glm::vec3 randomDirection(std::mt19937& random) {
    std::normal_distribution<float> normal;
    return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
}

// Asks from so many places around the light, as far as `farthest` from the origin [m].
void expectEqualSums(const EmitterSet& set, float nearest, float farthest, uint32_t places) {
    shader::WholeTables tables{&set, emitterEdges(set.polygons)};
    const auto polygons = uint32_t(set.polygons.size()), edges = uint32_t(tables.edges.size());
    std::mt19937 random(5);
    std::uniform_real_distribution<float> distance(nearest, farthest);
    uint32_t lit = 0;
    for (uint32_t i = 0; i < places; ++i) {
        const glm::vec3 p = distance(random) * randomDirection(random), n = randomDirection(random);
        const glm::vec3 exact = sumOfFormFactors(set, p, n);
        const glm::vec3 found = tables.wholeEmitterLight(p, n, polygons, edges);
        const float most = std::max({exact.x, exact.y, exact.z});
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(found[c], exact[c], 2e-4f * most + 1e-6f) << "place " << i;
        lit += most > 0 ? 1 : 0;
    }
    EXPECT_GT(lit, places / 4);
}

TEST(EmitterEdges, TwoPolygonsShareOne) {
    const EmitterSet cube = test::emittersOf(test::glowing(test::cube()));
    ASSERT_EQ(cube.polygons.size(), 6u);
    const std::vector<shader::EmitterEdge> edges = emitterEdges(cube.polygons);
    EXPECT_EQ(edges.size(), 12u);
    for (const shader::EmitterEdge& edge : edges) {
        EXPECT_NE(edge.polygon, edge.polygonBeyond);
        EXPECT_NEAR(glm::dot(edge.normal, edge.normalBeyond), 0.0f, 1e-6f);
    }
    const EmitterSet square = test::emittersOf(test::glowing(test::square()));
    ASSERT_EQ(square.polygons.size(), 1u);
    EXPECT_EQ(emitterEdges(square.polygons).size(), 4u);
}

TEST(WholeEmitter, OfAClosedMeshIsThatOfItsOutline) {
    expectEqualSums(test::emittersOf(test::glowing(test::sphere(16), {3, 2, 1})), 1.2f, 9.0f, 2000);
    expectEqualSums(test::emittersOf(test::glowing(test::cube(), {1, 1, 1})), 2.0f, 9.0f, 2000);
}

// A polygon may hide others of the light from the receiver: what all bring without shadows counts them, too.
TEST(WholeEmitter, OfOtherMeshesIsTheSumOfFormFactors) {
    expectEqualSums(test::emittersOf(test::glowing(test::torusKnot(40, 8))), 4.0f, 12.0f, 500);
    expectEqualSums(test::emittersOf(test::manyLamps(40, 0.2f)), 2.5f, 9.0f, 1000); // of unlike radiance
    const auto pixel = [](uint32_t x, uint32_t y) { return glm::u8vec3(20 * x + 20, 255 - 30 * y, 99); };
    expectEqualSums(test::emittersOf(test::glowingPicture(8, 8, pixel)), 2.0f, 9.0f, 1000);
}

TEST(WholeEmitter, OnTheCpuIsThatOfTheShader) {
    const EmitterSet set = test::emittersOf(test::glowing(test::sphere(12), {3, 2, 1}));
    shader::WholeTables tables{&set, emitterEdges(set.polygons)};
    const auto whole = [&](const glm::vec3& p, const glm::vec3& n) {
        return tables.wholeEmitterLight(p, n, uint32_t(set.polygons.size()), uint32_t(tables.edges.size()));
    };
    constexpr uint32_t kChunks = 5;
    std::vector<shader::Patch> patches(kChunks * shader::kChunk);
    std::vector<shader::PatchCover> covers(patches.size());
    std::mt19937 random(6);
    for (size_t i = 0; i < patches.size(); ++i) {
        patches[i].position = (1.01f + 0.01f * float(i % 240)) * randomDirection(random);
        patches[i].normal = patches[i].shading = randomDirection(random);
        patches[i].area = 0.01f;
        const glm::vec3 du = 0.1f * glm::normalize(glm::cross(patches[i].normal, glm::vec3(1, 2, 3)));
        covers[i] = {du, shader::kCoverCells | shader::kCoverWhole, glm::cross(patches[i].normal, du),
                     shader::kCoverPlaces / 2 | shader::kCoverPlaces / 2 << 16};
        patches[i].flags = i % 7 == 0 ? 0 : shader::kPatchSends;
    }
    std::vector<glm::vec4> wholes(patches.size(), glm::vec4(-1.0f));
    WorkerPool pool(2);
    findWholes(pool, {.polygons = set.polygons,
                      .edges = tables.edges,
                      .root = set.nodes.front(),
                      .patches = patches,
                      .covers = covers.data(),
                      .wholes = wholes,
                      .range = {1, kChunks - 1}});
    std::array<uint32_t, 3> kinds{};
    for (size_t i = 0; i < patches.size(); ++i) {
        if (i < shader::kChunk) {
            EXPECT_EQ(wholes[i], glm::vec4(-1.0f)) << "is not of the range";
            continue;
        }
        const shader::Patch& p = patches[i];
        const shader::TexelSpread spread = shader::texelSpread(p, covers[i]);
        const uint32_t kind =
            shader::unevenness(spread.size, shader::nodeDistance(spread.middle, set.nodes.front()));
        ++kinds[kind];
        const bool sends = p.flags != 0;
        EXPECT_EQ(wholes[i].w, sends && kind == shader::kLightUneven ? 1.0f : 0.0f);
        glm::vec3 light(0.0f);
        if (sends && kind == shader::kLightEven) light = whole(p.position, p.shading);
        for (uint32_t k = 0; sends && kind == shader::kLightCurved && k < shader::kSpreadPoints; ++k)
            light += whole(shader::spreadPoint(spread, k), p.shading) / float(shader::kSpreadPoints);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(wholes[i][c], light[c], 1e-5f * light[c] + 1e-6f) << i;
    }
    for (const uint32_t count : kinds)
        EXPECT_GT(count, 10u);
}

} // namespace
} // namespace relume
