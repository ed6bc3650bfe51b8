#include "assets/atlas/world_mesh.h"

#include "assets/atlas/uv_charts.h"
#include "assets/base/error.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

LightmapAtlas identityAtlas(const Scene& scene) {
    LightmapAtlas atlas;
    atlas.instances.resize(scene.instances.size());
    for (AtlasRect& rect : atlas.instances)
        rect.texCoord = 1;
    return atlas;
}

glm::vec3 face(const WorldMesh& mesh, uint32_t triangle) {
    const glm::vec3* p = &mesh.positions[3 * triangle];
    return glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
}

void expectSamePlace(const glm::vec3& a, const glm::vec3& b) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a[c], b[c], 1e-5f);
}

// So many triangles are listed by several threads, portion by portion.
TEST(WorldMesh, ManyTrianglesKeepTheirOrder) {
    constexpr uint32_t kTriangles = 150'000, kFlat = 7; // each so-manieth one has no area
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < kTriangles; ++i) {
        const float x = float(i % 500), y = float(i / 500);
        const bool flat = i % kFlat == 3;
        positions.insert(positions.end(),
                         {{x, y, 0}, {x + .5f, y, 0}, flat ? glm::vec3(x, y, 0) : glm::vec3(x, y + .5f, 0)});
        for (uint32_t k = 0; k < 3; ++k)
            indices.push_back(3 * i + k);
    }
    Primitive masked = test::primitiveOf(positions, indices), opaque = masked;
    masked.material = 0;
    opaque.material = 1;
    Scene scene = test::sceneOf(masked);
    scene.meshes[0].primitives.push_back(opaque);
    scene.materials.resize(2);
    scene.materials[0].alphaMode = AlphaMode::Mask;
    LightmapAtlas atlas;
    atlas.instances.resize(1);
    const WorldMesh mesh = flatten(scene, atlas);
    const uint32_t listed = kTriangles - (kTriangles - 3 + kFlat - 1) / kFlat;
    ASSERT_EQ(mesh.triangleCount(), 2 * listed);
    EXPECT_EQ(mesh.opaqueCount, listed);
    uint32_t place = 0;
    for (uint32_t i = 0; i < kTriangles; ++i) {
        if (i % kFlat == 3) continue;
        for (const uint32_t at : {place, listed + place}) {
            ASSERT_EQ(mesh.positions[3 * at], positions[3 * i]) << i;
            ASSERT_EQ(mesh.positions[3 * at + 2], positions[3 * i + 2]) << i;
            ASSERT_EQ(mesh.material[at], at < listed ? 1u : 0u) << i;
        }
        ++place;
    }
}

TEST(WorldMesh, PositionsUvsAndDefaults) {
    Scene scene = test::sceneOf(test::square());
    scene.instances[0].transform = glm::translate(glm::mat4(1), glm::vec3(1, 2, 3));
    scene.materials.resize(2);
    LightmapAtlas atlas = identityAtlas(scene);
    atlas.instances[0].scale = {.5f, .25f};
    atlas.instances[0].offset = {.25f, .5f};
    const WorldMesh mesh = flatten(scene, atlas);
    ASSERT_EQ(mesh.triangleCount(), 2u);
    EXPECT_EQ(mesh.opaqueCount, 2u);
    EXPECT_EQ(mesh.chartCount, 1u);
    expectSamePlace(mesh.positions[1], {2, 2, 3});
    EXPECT_EQ(mesh.lightmapUv[0], glm::vec2(.25f, .5f));
    EXPECT_EQ(mesh.lightmapUv[2], glm::vec2(.75f, .75f));
    EXPECT_EQ(mesh.colors[0], glm::vec4(1));
    EXPECT_EQ(mesh.material[0], 2u); // the default material stands behind the scene's own
    EXPECT_EQ(mesh.instance[1], 0u);
    EXPECT_EQ(mesh.normals.size(), 6u);
    EXPECT_EQ(mesh.baseUv.size(), 6u);
    EXPECT_EQ(mesh.emissionUv.size(), 6u);
    EXPECT_EQ(mesh.metallicUv.size(), 6u);
}

TEST(WorldMesh, HiddenInstancesAreLeftOut) {
    Scene scene = test::sceneOf(test::square());
    scene.instances.push_back(scene.instances[0]);
    scene.instances[0].hidden = true;
    scene.instances[1].transform = glm::translate(glm::mat4(1), glm::vec3(1, 2, 3));
    const LightmapAtlas atlas = identityAtlas(scene);
    const WorldMesh mesh = flatten(scene, atlas);
    ASSERT_EQ(mesh.triangleCount(), 2u);
    EXPECT_EQ(mesh.instance, (std::vector<uint32_t>{1, 1}));
    scene.instances[1].hidden = true;
    EXPECT_THROW(flatten(scene, atlas), Error);
}

TEST(WorldMesh, MirroredInstancesKeepTheirFront) {
    Scene scene = test::sceneOf(test::square());
    const glm::mat4 flips[] = {glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1)),
                               glm::scale(glm::mat4(1), glm::vec3(1, 1, -1)),
                               glm::scale(glm::mat4(1), glm::vec3(-1, -1, -1))};
    for (const glm::mat4& flip : flips)
        test::addInstance(scene, 0, flip);
    const WorldMesh mesh = flatten(scene, identityAtlas(scene));
    ASSERT_EQ(mesh.triangleCount(), 8u);
    // The front of the square is +z; mirroring in x keeps it there, mirroring in z turns it.
    const glm::vec3 fronts[] = {{0, 0, 1}, {0, 0, 1}, {0, 0, -1}, {0, 0, -1}};
    for (uint32_t i = 0; i < 8; ++i) {
        expectSamePlace(face(mesh, i), fronts[i / 2]);
        for (uint32_t k = 0; k < 3; ++k)
            expectSamePlace(mesh.normals[3 * i + k], fronts[i / 2]);
    }
}

TEST(WorldMesh, NormalsStayPerpendicularUnderUnevenScale) {
    Primitive slope = test::primitiveOf({{0, 0, 0}, {1, 0, 0}, {0, 1, -1}}, {0, 1, 2});
    slope.normals.assign(3, glm::normalize(glm::vec3(0, 1, 1)));
    slope.texCoord1 = {{0, 0}, {1, 0}, {0, 1}};
    Scene scene = test::sceneOf(slope);
    scene.instances[0].transform = glm::scale(glm::mat4(1), glm::vec3(1e-3f, 5e-3f, 1e-3f));
    const WorldMesh mesh = flatten(scene, identityAtlas(scene));
    expectSamePlace(mesh.normals[0], face(mesh, 0));
    EXPECT_NEAR(glm::length(mesh.normals[0]), 1.0f, 1e-6f);
}

TEST(WorldMesh, TrianglesWithoutAreaAreDropped) {
    Primitive p =
        test::primitiveOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1e30f, 0, 0}, {0, 1e30f, 0}},
                          {0, 1, 2, 0, 1, 3, 0, 0, 1, 0, 4, 5});
    p.texCoord1.assign(6, glm::vec2(0));
    p.texCoord1[1] = {1, 0};
    p.texCoord1[2] = {1, 1};
    const Scene scene = test::sceneOf(p);
    const WorldMesh mesh = flatten(scene, identityAtlas(scene));
    EXPECT_EQ(mesh.triangleCount(), 1u);
    EXPECT_EQ(mesh.chartCount, 1u);

    Scene flat = test::sceneOf(test::square());
    flat.instances[0].transform = glm::scale(glm::mat4(1), glm::vec3(1, 0, 1));
    EXPECT_THROW(flatten(flat, identityAtlas(flat)), Error);
}

TEST(WorldMesh, BadShadingNormalsFallBackToTheTriangles) {
    Scene scene = test::sceneOf(test::square());
    scene.meshes[0].primitives[0].normals.assign(4, glm::vec3(0));
    const WorldMesh mesh = flatten(scene, identityAtlas(scene));
    for (const glm::vec3& normal : mesh.normals)
        expectSamePlace(normal, {0, 0, 1});
}

TEST(WorldMesh, MaskedTrianglesComeLast) {
    Scene scene;
    scene.materials.resize(2);
    scene.materials[0].alphaMode = AlphaMode::Mask;
    scene.materials[1].alphaMode = AlphaMode::Blend;
    for (int material : {0, 1, 0, -1}) {
        Primitive p = test::square();
        p.material = material;
        test::addInstance(scene, test::addMesh(scene, p));
    }
    const WorldMesh mesh = flatten(scene, identityAtlas(scene));
    EXPECT_EQ(mesh.opaqueCount, 4u);
    EXPECT_EQ(mesh.material, (std::vector<uint32_t>{1, 1, 2, 2, 0, 0, 0, 0}));
    EXPECT_EQ(mesh.instance, (std::vector<uint32_t>{1, 1, 3, 3, 0, 0, 2, 2}));
    EXPECT_EQ(mesh.chart, (std::vector<uint32_t>{0, 0, 1, 1, 2, 2, 3, 3}));
}

TEST(WorldMesh, TextureUvsFollowTheMaterial) {
    Primitive p = test::square();
    p.texCoord0 = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    p.material = 0;
    Scene scene = test::sceneOf(p);
    scene.materials.resize(1);
    scene.materials[0].baseColorTexture = {0, 0, glm::mat3(1, 0, 0, 0, -1, 0, 0, 1, 1)}; // v' = 1 - v
    scene.materials[0].emissionTexture = {0, 1, glm::mat3(1)};
    const WorldMesh mesh = flatten(scene, identityAtlas(scene));
    EXPECT_EQ(mesh.baseUv[2], glm::vec2(2, -1));
    EXPECT_EQ(mesh.emissionUv[2], glm::vec2(1, 1));
    EXPECT_EQ(mesh.metallicUv[2], glm::vec2(0, 0));
}

TEST(WorldMesh, InstancesWithoutUvsHaveNoChart) {
    Scene scene = test::sceneOf(test::square());
    Primitive bare = test::square();
    bare.texCoord1.clear();
    scene.meshes[0].primitives.push_back(bare);
    test::addInstance(scene, test::addMesh(scene, bare));
    LightmapAtlas atlas = identityAtlas(scene);
    atlas.instances[1].texCoord = -1;
    const WorldMesh mesh = flatten(scene, atlas);
    EXPECT_EQ(mesh.chart, (std::vector<uint32_t>{0, 0, kNoChart, kNoChart, kNoChart, kNoChart}));
    EXPECT_EQ(mesh.chartCount, 1u);
}

TEST(Charts, ConnectThroughEqualPositionsAndUvsOnly) {
    // These are two unit squares side by side, every triangle with vertices of its own.
    const glm::vec3 p[6] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
    const int corners[12] = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    const auto make = [&](float gap, int moved) {
        Primitive primitive = test::primitiveOf({}, {});
        for (int i = 0; i < 12; ++i) {
            primitive.indices.push_back(static_cast<uint32_t>(i));
            primitive.positions.push_back(p[corners[i]]);
            // The right square's UVs start `gap` further right.
            glm::vec2 uv = glm::vec2(p[corners[i]]) * 0.4f + glm::vec2(i >= 6 ? gap : 0.0f, 0.0f);
            if (i == moved) uv.y += 0.01f;
            primitive.texCoord1.push_back(uv);
        }
        return findCharts({"", {primitive}}, 1);
    };
    EXPECT_EQ(make(0.0f, -1).count, 1u);
    EXPECT_EQ(make(0.1f, -1).count, 2u);
    EXPECT_EQ(make(0.1f, -1).chart[0], (std::vector<uint32_t>{0, 0, 1, 1}));
    EXPECT_EQ(make(0.0f, 1).count, 2u); // one end of the edge between the squares has moved
    EXPECT_EQ(make(0.0f, 2).count, 3u); // one end of both edges that hold the first triangle
}

TEST(Charts, TouchingAtACornerDoesNotConnect) {
    Primitive primitive =
        test::primitiveOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {0, 1, 2, 0, 3, 4});
    for (const glm::vec3& p : primitive.positions)
        primitive.texCoord1.push_back(glm::vec2(p) * 0.5f + 0.5f);
    EXPECT_EQ(findCharts({"", {primitive}}, 1).count, 2u);
}

TEST(Charts, SpanPrimitivesAndAreCountedPerInstance) {
    Primitive left = test::square({0, 0}, {.5f, .5f}), right = test::square({.5f, 0}, {1, .5f});
    for (glm::vec3& p : right.positions)
        p.x += 1;
    Scene scene;
    scene.meshes.push_back({"", {left, right}});
    test::addInstance(scene, 0);
    test::addInstance(scene, 0);
    EXPECT_EQ(findCharts(scene.meshes[0], 1).count, 1u);
    const WorldMesh mesh = flatten(scene, identityAtlas(scene));
    EXPECT_EQ(mesh.chart, (std::vector<uint32_t>{0, 0, 0, 0, 1, 1, 1, 1}));
    EXPECT_EQ(mesh.chartCount, 2u);
}

} // namespace
} // namespace relume
