#include "assets/atlas/unwrap.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/planar_charts.h"
#include "assets/atlas/uv_charts.h"
#include "assets/atlas/uv_sets.h"
#include "assets/atlas/world_mesh.h"
#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/glb_builder.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace relume {
namespace {

/// Expects that every mesh of the scene has become a valid atlas that still shows the same triangles.
void expectValid(Scene scene, const UnwrapDesc& desc, const std::string& name) {
    SCOPED_TRACE(name);
    const Scene before = scene;
    unwrap(scene, desc);
    ASSERT_EQ(scene.meshes.size(), before.meshes.size());
    for (size_t m = 0; m < scene.meshes.size(); ++m) {
        EXPECT_EQ(lightmapSet(scene.meshes[m]), 1);
        for (size_t k = 0; k < scene.meshes[m].primitives.size(); ++k) {
            const Primitive &now = scene.meshes[m].primitives[k], &then = before.meshes[m].primitives[k];
            ASSERT_EQ(now.texCoord1.size(), now.positions.size());
            ASSERT_EQ(now.normals.size(), now.positions.size());
            ASSERT_EQ(now.indices.size(), then.indices.size());
            for (size_t i = 0; i < now.indices.size(); ++i)
                ASSERT_EQ(now.positions[now.indices[i]], then.positions[then.indices[i]]);
            for (const glm::vec2& uv : now.texCoord1) {
                ASSERT_GE(std::min(uv.x, uv.y), 0.0f);
                ASSERT_LE(std::max(uv.x, uv.y), 1.0f);
            }
        }
    }
    const LightmapAtlas atlas = buildAtlas(scene, desc.size);
    EXPECT_LT(measureAtlas(scene, atlas, desc.size).overlap, 0.01);
    const WorldMesh mesh = flatten(scene, atlas);
    EXPECT_EQ(std::count(mesh.chart.begin(), mesh.chart.end(), kNoChart), 0);
    EXPECT_EQ(mesh.triangleCount(),
              flatten(before, LightmapAtlas{std::vector<AtlasRect>(scene.instances.size()), false, {}})
                  .triangleCount());
}

UnwrapDesc withDensity(double density) {
    UnwrapDesc desc;
    desc.density = density;
    return desc;
}

TEST(Unwrap, CubeBecomesSixSquares) {
    Scene scene = test::sceneOf(test::cube());
    const UnwrapResult result = unwrap(scene, {.density = 16, .size = 0});
    EXPECT_GE(result.size, 52u); // three squares of 16 texels and two gutters of 2
    EXPECT_LE(result.size, 56u);
    EXPECT_EQ(result.meshes, 1u);
    EXPECT_EQ(result.objects, 1u);
    EXPECT_EQ(result.charts, 6u);
    EXPECT_EQ(result.density, 16.0);
    EXPECT_EQ(scene.meshes[0].primitives[0].positions.size(), 24u);
    EXPECT_EQ(flatten(scene, buildAtlas(scene, 64)).chartCount, 6u);
    // Six squares of 16 texels are packed three by two: no density is lost to stretching.
    const AtlasStatistics statistics = measureAtlas(scene, buildAtlas(scene, 64), 64);
    EXPECT_NEAR(statistics.texelDensityMin, statistics.texelDensityMax, 1e-3 * statistics.texelDensityMax);
    EXPECT_GT(statistics.coverage, 0.5);
    expectValid(test::sceneOf(test::cube()), {}, "cube");
}

TEST(Unwrap, SmoothClosedSurfaces) {
    expectValid(test::sceneOf(test::sphere()), {}, "sphere");
    expectValid(test::sceneOf(test::torusKnot()), {}, "knot");
    expectValid(test::sceneOf(test::torusKnot()), withDensity(100), "knot at 100 texels/m");
}

TEST(Unwrap, AnyScale) {
    for (float scale : {1e-12f, 1e-3f, 1e4f, 1e8f}) {
        Primitive knot = test::torusKnot(100, 12);
        for (glm::vec3& p : knot.positions)
            p *= scale;
        SCOPED_TRACE(scale);
        Scene scene = test::sceneOf(knot);
        unwrap(scene, {});
        EXPECT_EQ(lightmapSet(scene.meshes[0]), 1);
    }
}

TEST(Unwrap, TrianglesInAnyOrder) {
    expectValid(test::sceneOf(test::soup(3000, 9000, 1)), {}, "loose");
    expectValid(test::sceneOf(test::soup(3000, 400, 2)), {}, "not manifold");
    expectValid(test::sceneOf(test::soup(1, 3, 3)), {}, "single");
}

std::string unwrapError(Scene scene, const UnwrapDesc& desc) {
    try {
        unwrap(scene, desc);
    } catch (const Error& error) {
        return error.what();
    }
    return "none";
}

TEST(Unwrap, ANeedleIsShortened) {
    Primitive needle = test::square();
    needle.texCoord1.clear();
    for (glm::vec3& p : needle.positions)
        p *= glm::vec3(1e6f, 1e-3f, 1.0f);
    Scene scene = test::sceneOf(test::cube());
    test::addInstance(scene, test::addMesh(scene, needle, "Needle"));
    EXPECT_EQ(unwrapError(scene, {.density = 10, .size = 0}),
              "test.glb: mesh 'Needle', the longest, and all others need more than 16384 texels a side at 10 "
              "texels/m: use a lower --density");
    const UnwrapResult result = unwrap(scene, {});
    EXPECT_EQ(result.meshes, 2u);
    EXPECT_GT(result.density, 150.0); // the cube's: three squares and their gutters are at most 512 texels
    EXPECT_LT(result.density, 175.0);
    for (const Mesh& mesh : scene.meshes)
        EXPECT_EQ(lightmapSet(mesh), 1);
}

// A strip of 100 x 1 m is longer than the atlas at the density that fills it: what is told of it must be what
// its UVs have.
TEST(Unwrap, ALongStripTellsTheDensityThatItHas) {
    Primitive strip = test::square();
    strip.texCoord1.clear();
    for (glm::vec3& p : strip.positions)
        p *= glm::vec3(100.0f, 1.0f, 1.0f);
    for (const uint32_t size : {128u, 512u}) {
        Scene scene = test::sceneOf(strip);
        const UnwrapResult result = unwrap(scene, {.size = size});
        const std::vector<glm::vec2>& uv = scene.meshes[0].primitives[0].texCoord1;
        const std::vector<glm::vec3>& positions = scene.meshes[0].primitives[0].positions;
        double along = 0.0, across = 0.0; // [texels/m]
        for (size_t i = 0; i < uv.size(); ++i)
            for (size_t k = 0; k < i; ++k) {
                const double texels = size * glm::distance(uv[i], uv[k]);
                const double metres = glm::distance(positions[i], positions[k]);
                if (metres == 100.0) along = texels / metres;
                if (metres == 1.0) across = texels / metres;
            }
        EXPECT_NEAR(result.leastDensity, along, 0.02 * along) << size;
        EXPECT_NEAR(result.leastDensity, size / 100.0, 0.02 * size / 100.0) << size;
        EXPECT_EQ(result.shortened, result.leastDensity < result.density ? 1u : 0u) << size;
        EXPECT_LE(result.density, across + 1.0) << "but for the rounding to whole texels";
    }
    Scene square = test::sceneOf(test::cube());
    const UnwrapResult result = unwrap(square, {.size = 128});
    EXPECT_EQ(result.shortened, 0u);
    EXPECT_EQ(result.leastDensity, result.density);
}

TEST(Unwrap, WithoutAnAreaNoUnwrapIsAdvised) {
    Primitive line = test::square();
    line.texCoord1.clear();
    for (glm::vec3& p : line.positions)
        p.y = p.z = 0;
    Scene scene = test::sceneOf(line);
    scene.path = "line.glb";
    const UnwrapResult result = unwrap(scene, {});
    EXPECT_EQ(result.meshes, 0u);
    EXPECT_EQ(result.density, 0.0);
    try {
        requireArea(scene);
        ADD_FAILURE() << "a line has an area";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "line.glb: has no triangle with an area: export it with its geometry");
    }
    test::addInstance(scene, test::addMesh(scene, test::cube()));
    EXPECT_NO_THROW(requireArea(scene));
    const auto warning = [&](bool unwrapped) {
        Scene mapped = scene;
        unwrap(mapped, {});
        return buildAtlas(mapped, 64, unwrapped).warnings.at(0);
    };
    EXPECT_NE(warning(false).find("leave out --no-unwrap"), std::string::npos) << warning(false);
    EXPECT_EQ(warning(true).find("leave out --no-unwrap"), std::string::npos) << warning(true);
}

TEST(Unwrap, MoebiusStrip) {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    constexpr uint32_t kSteps = 60;
    for (uint32_t i = 0; i < kSteps; ++i)
        for (float w : {-0.3f, 0.3f}) {
            const float t = 6.28318531f * float(i) / kSteps, r = 1.0f + w * std::cos(0.5f * t);
            positions.push_back({r * std::cos(t), r * std::sin(t), w * std::sin(0.5f * t)});
        }
    for (uint32_t i = 0; i < kSteps; ++i) {
        const bool last = i + 1 == kSteps; // joined upside down
        const uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
        indices.insert(indices.end(), {a, c, d, a, d, b});
    }
    expectValid(test::sceneOf(test::primitiveOf(positions, indices)), {}, "moebius");
}

/// A flat ribbon winds twice around the centre at a gentle slope: all normals agree, but its projection
/// overlaps.
TEST(Unwrap, SpiralThatOverlapsItsOwnProjectionIsCut) {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i <= 128; ++i)
        for (float r : {1.0f, 2.0f}) {
            const float t = 12.5663706f * float(i) / 128;
            positions.push_back({r * std::cos(t), r * std::sin(t), 0.05f * t});
        }
    for (uint32_t i = 0; i < 128; ++i) {
        const uint32_t a = 2 * i;
        indices.insert(indices.end(), {a, a + 1, a + 3, a, a + 3, a + 2});
    }
    Scene scene = test::sceneOf(test::primitiveOf(positions, indices));
    const UnwrapResult result = unwrap(scene, {});
    EXPECT_GE(result.charts, 2u);
    EXPECT_LE(result.charts, 8u);
    expectValid(test::sceneOf(test::primitiveOf(positions, indices)), {}, "spiral");
}

double uvArea(const Mesh& mesh) {
    double area = 0.0;
    for (const Primitive& p : mesh.primitives)
        for (size_t i = 0; i < p.indices.size(); i += 3) {
            const glm::dvec2 a(p.texCoord1[p.indices[i]]);
            const glm::dvec2 b = glm::dvec2(p.texCoord1[p.indices[i + 1]]) - a;
            const glm::dvec2 c = glm::dvec2(p.texCoord1[p.indices[i + 2]]) - a;
            area += 0.5 * std::abs(b.x * c.y - b.y * c.x);
        }
    return area;
}

TEST(Unwrap, DensityIsThatOfTheWorld) {
    // It is twice as large in the world as in the mesh: 2 m at 50 texels/m.
    Primitive square = test::square();
    square.texCoord1.clear();
    std::vector<glm::dvec3> corners;
    for (uint32_t i : square.indices)
        corners.push_back(2.0 * glm::dvec3(square.positions[i]));
    const std::vector<PlanarChart> charts = cutPlanarCharts(corners);
    ASSERT_EQ(charts.size(), 1u);
    EXPECT_NEAR(charts[0].extent.x, 2.0, 1e-9);
    EXPECT_NEAR(charts[0].extent.y, 2.0, 1e-9);

    Scene scene;
    const int mesh = test::addMesh(scene, square);
    test::addInstance(scene, mesh, glm::scale(glm::mat4(1), glm::vec3(2)));
    test::addInstance(scene, mesh, glm::translate(glm::mat4(1), glm::vec3(9, 0, 0)));
    // A square of 2 m and one of 1 m stand side by side with 2 texels between them; texels that are 4 % wider
    // than high give the one direction that is full 2 % more.
    const UnwrapResult result = unwrap(scene, {});
    EXPECT_GE(result.density, 510.0 / 3.0 - 1.0);
    EXPECT_LE(result.density, 510.0 / 3.0 * 1.03);
    EXPECT_EQ(result.objects, 2u);
    EXPECT_EQ(result.meshes, 1u);
    ASSERT_EQ(scene.meshes.size(), 2u); // UVs of its own for each instance
    EXPECT_NE(scene.instances[0].mesh, scene.instances[1].mesh);
    EXPECT_FALSE(buildAtlas(scene, 512).repacked);
    EXPECT_NEAR(uvArea(scene.meshes[0]) / uvArea(scene.meshes[1]), 4.0, 0.1);
}

TEST(Unwrap, FittedDensityKeepsTheGutterOnTheTexelGrid) {
    // A mesh alone is the atlas: each chart of the cube is a box of whole texels, two or more from the next.
    Scene scene = test::sceneOf(test::cube());
    UnwrapDesc desc;
    desc.size = 100;
    unwrap(scene, desc);
    ASSERT_FALSE(buildAtlas(scene, 100).repacked);
    const Primitive& p = scene.meshes[0].primitives[0];
    std::vector<glm::vec2> low(6, glm::vec2(200)), high(6, glm::vec2(-1));
    for (size_t v = 0; v < 24; ++v) {
        low[v / 4] = glm::min(low[v / 4], 100.0f * p.texCoord1[v]);
        high[v / 4] = glm::max(high[v / 4], 100.0f * p.texCoord1[v]);
        for (int c = 0; c < 2; ++c)
            EXPECT_NEAR(100 * p.texCoord1[v][c], std::round(100 * p.texCoord1[v][c]), 1e-3f);
    }
    for (size_t a = 0; a < 6; ++a) {
        EXPECT_GT(high[a].x - low[a].x, 25.0f); // 3 by 2 of at most 32
        for (size_t b = 0; b < a; ++b)
            EXPECT_TRUE(high[a].x + 1.99f < low[b].x || high[b].x + 1.99f < low[a].x ||
                        high[a].y + 1.99f < low[b].y || high[b].y + 1.99f < low[a].y);
    }
}

TEST(Unwrap, ValidUvsStayUnlessAskedFor) {
    Scene scene = test::sceneOf(test::square());
    test::addInstance(scene, test::addMesh(scene, test::cube(), "Bare"));
    const std::vector<glm::vec2> uvs = scene.meshes[0].primitives[0].texCoord1;
    Scene all = scene;
    const UnwrapResult result = unwrap(scene, {});
    EXPECT_EQ(result.meshes, 1u);
    EXPECT_EQ(result.objects, 2u);
    // What was valid moves as one chart, at the density of all.
    ASSERT_FALSE(buildAtlas(scene, 512).repacked);
    EXPECT_EQ(findCharts(scene.meshes[0], 1).count, 1u);
    EXPECT_NEAR(uvArea(scene.meshes[0]), uvArea(scene.meshes[1]) / 6.0, 0.02 * uvArea(scene.meshes[0]));
    Scene valid = test::sceneOf(test::square());
    test::addInstance(valid, 0);
    EXPECT_EQ(unwrap(valid, {}).meshes, 0u);
    EXPECT_EQ(valid.meshes.size(), 1u);
    EXPECT_EQ(valid.meshes[0].primitives[0].texCoord1, uvs);
    UnwrapDesc desc;
    desc.onlyMissing = false;
    EXPECT_EQ(unwrap(all, desc).meshes, 2u);
}

TEST(Unwrap, TexturesOnTexCoord1MoveAside) {
    Scene scene = test::sceneOf(test::square({0, 0}, {4, 4})); // tiles: no lightmap
    scene.images.push_back({"", 1, 1, {1, 2, 3, 4}});
    scene.textures.push_back({0, Wrap::Repeat, Wrap::Repeat, false});
    scene.materials.resize(1);
    scene.materials[0].baseColorTexture = {0, 1, glm::mat3(1)};
    scene.meshes[0].primitives[0].material = 0;
    unwrap(scene, {});
    const Primitive& primitive = scene.meshes[0].primitives[0];
    EXPECT_EQ(primitive.movedUvs, 0);
    EXPECT_EQ(&uvsOf(primitive, scene.materials[0].baseColorTexture), &primitive.texCoord0);
    EXPECT_EQ(scene.materials.size(), 1u) << "edits go by the file's list";
    EXPECT_EQ(scene.materials[0].baseColorTexture.texCoord, 1); // other meshes may still use it
    EXPECT_EQ(*std::max_element(primitive.texCoord0.begin(), primitive.texCoord0.end(),
                                [](const glm::vec2& a, const glm::vec2& b) { return a.x + a.y < b.x + b.y; }),
              glm::vec2(4, 4));
    EXPECT_EQ(lightmapSet(scene.meshes[0]), 1);
    // Whoever reads the scene that is written finds the texture where it was, and the lightmap beside it.
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, 64));
    const std::string path = test::tempPath("moved.glb");
    saveGlb(scene, path);
    const Scene written = loadGltf(path);
    ASSERT_EQ(written.materials.size(), 2u) << "a copy for the primitive";
    EXPECT_EQ(written.materials[1].baseColorTexture.texCoord, 0);
    const WorldMesh again = flatten(written, buildAtlas(written, 64));
    EXPECT_EQ(again.baseUv, mesh.baseUv);
    EXPECT_EQ(again.lightmapUv, mesh.lightmapUv);
}

/// A square whose base colour reads TEXCOORD_1, which tiles, and whose emission reads TEXCOORD_0.
Scene squareOfTwoSets() {
    Scene scene = test::sceneOf(test::square({0, 0}, {4, 4}));
    Primitive& primitive = scene.meshes[0].primitives[0];
    primitive.texCoord0 = test::square({0, 0}, {3, 2}).texCoord1;
    primitive.material = 0;
    scene.images.push_back({"", 1, 1, {1, 2, 3, 4}});
    scene.textures.push_back({0, Wrap::Repeat, Wrap::Repeat, false});
    scene.materials.resize(1);
    scene.materials[0].baseColorTexture = {0, 1, glm::mat3(1)};
    scene.materials[0].emission = glm::vec3(1.0f);
    scene.materials[0].emissionTexture = {0, 0, glm::mat3(1)};
    return scene;
}

// A normal map's UVs move along; where it alone needs a third set, the mesh gets its lightmap all the same.
TEST(Unwrap, UvsOfKeptMapsMoveToo) {
    Scene scene = squareOfTwoSets();
    const Primitive before = scene.meshes[0].primitives[0];
    Material& material = scene.materials[0];
    material.baseColorTexture = {};
    material.normalMap.use = {0, 1, glm::mat3(1)};
    EXPECT_EQ(unwrap(scene, {}).meshes, 1u);
    EXPECT_EQ(uvsOf(scene.meshes[0].primitives[0], material.normalMap.use), before.texCoord1);
    EXPECT_EQ(uvsOf(scene.meshes[0].primitives[0], material.emissionTexture), before.texCoord0);
    scene = squareOfTwoSets();
    scene.meshes[0].primitives[0].texCoord2 = before.texCoord0;
    scene.materials[0].normalMap.use = {0, 2, glm::mat3(1)};
    EXPECT_EQ(unwrap(scene, {}).meshes, 1u);
    EXPECT_EQ(lightmapSet(scene.meshes[0]), 1);
    EXPECT_EQ(uvsOf(scene.meshes[0].primitives[0], scene.materials[0].baseColorTexture), before.texCoord1);
}

TEST(Unwrap, AMeshWhoseTexturesNeedBothSetsGetsAThird) {
    Scene scene = squareOfTwoSets();
    const Primitive before = scene.meshes[0].primitives[0];
    EXPECT_EQ(unwrap(scene, {}).meshes, 1u);
    const Primitive& primitive = scene.meshes[0].primitives[0];
    const Material& material = scene.materials[0];
    EXPECT_EQ(lightmapSet(scene.meshes[0]), 1) << "where engines look for it";
    EXPECT_EQ(primitive.movedUvs, 2);
    EXPECT_EQ(uvsOf(primitive, material.baseColorTexture), before.texCoord1);
    EXPECT_EQ(uvsOf(primitive, material.emissionTexture), before.texCoord0);
    // The scene that is written looks alike, and needs no unwrap.
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, 64));
    const std::string path = test::tempPath("three_sets.glb");
    saveGlb(scene, path);
    Scene written = loadGltf(path);
    EXPECT_TRUE(written.warnings.empty()) << written.warnings.at(0);
    const Primitive& again = written.meshes.at(0).primitives.at(0);
    EXPECT_EQ(written.materials.at(static_cast<size_t>(again.material)).baseColorTexture.texCoord, 2);
    const WorldMesh read = flatten(written, buildAtlas(written, 64));
    EXPECT_EQ(read.baseUv, mesh.baseUv);
    EXPECT_EQ(read.emissionUv, mesh.emissionUv);
    EXPECT_EQ(read.lightmapUv, mesh.lightmapUv);
    EXPECT_EQ(unwrap(written, {}).meshes, 0u);
    // So does one whose UVs are made anew.
    UnwrapDesc desc;
    desc.onlyMissing = false;
    EXPECT_EQ(unwrap(written, desc).meshes, 1u);
    EXPECT_EQ(uvsOf(written.meshes[0].primitives[0], material.baseColorTexture).size(),
              written.meshes[0].primitives[0].positions.size());
    EXPECT_EQ(flatten(written, buildAtlas(written, 64)).baseUv, mesh.baseUv);
}

TEST(Unwrap, LightmapUvsThatMoveToTheSecondSetLeaveTexturesTheirs) {
    // The lightmap has TEXCOORD_0, two instances of it make rectangles, and base colour reads TEXCOORD_1.
    Scene scene = squareOfTwoSets();
    scene.meshes[0].primitives[0].texCoord0 = test::square().texCoord1;
    test::addInstance(scene, 0, glm::translate(glm::mat4(1), glm::vec3(3, 0, 0)));
    const LightmapAtlas atlas = buildAtlas(scene, 64);
    ASSERT_EQ(atlas.instances[0].texCoord, 0);
    const WorldMesh before = flatten(scene, atlas);
    const Scene placed = withAtlas(scene, atlas);
    const WorldMesh after = flatten(placed, buildAtlas(placed, 64));
    EXPECT_EQ(after.lightmapUv, before.lightmapUv);
    EXPECT_EQ(after.baseUv, before.baseUv);
    EXPECT_EQ(after.emissionUv, before.emissionUv);
}

TEST(Unwrap, AMeshThatNeedsThreeSetsIsLeftAlone) {
    Scene scene = squareOfTwoSets();
    scene.materials[0].metallicRoughnessTexture = {0, 2, glm::mat3(1)};
    scene.meshes[0].primitives[0].texCoord2 = scene.meshes[0].primitives[0].texCoord0;
    test::addInstance(scene, test::addMesh(scene, test::cube()));
    EXPECT_EQ(unwrap(scene, {}).meshes, 1u);
    EXPECT_EQ(scene.meshes[0].primitives[0].texCoord1[2], glm::vec2(4, 4));
    EXPECT_EQ(lightmapSet(scene.meshes[1]), 1);
}

TEST(Unwrap, AnObjectsDensityCountsForItAlone) {
    Scene scene;
    const int mesh = test::addMesh(scene, test::cube());
    for (int i = 0; i < 3; ++i)
        test::addInstance(scene, mesh, glm::translate(glm::mat4(1), glm::vec3(2 * i, 0, 0)));
    scene.instances[1].density = 2.0f;
    scene.instances[2].density = 0.5f;
    const UnwrapResult result = unwrap(scene, {.density = 0, .size = 512});
    const auto areaOf = [&](size_t i) {
        return uvArea(scene.meshes[static_cast<size_t>(scene.instances[i].mesh)]);
    };
    EXPECT_NEAR(areaOf(1) / areaOf(0), 4.0, 0.15);
    EXPECT_NEAR(areaOf(2) / areaOf(0), 0.25, 0.01);
    EXPECT_NEAR(areaOf(0) * 512 * 512, 6.0 * result.density * result.density, 0.02 * areaOf(0) * 512 * 512);
}

TEST(Unwrap, TurnedAndStretchedInstances) {
    Scene scene;
    const int mesh = test::addMesh(scene, test::cube());
    test::addInstance(scene, mesh, glm::rotate(glm::mat4(1), 1.1f, glm::vec3(1, 2, 3)));
    test::addInstance(scene, mesh, glm::scale(glm::mat4(1), glm::vec3(1, 4, 1)));
    test::addInstance(scene, mesh, glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1)));
    const UnwrapResult result = unwrap(scene, {.density = 20, .size = 0});
    EXPECT_EQ(result.charts, 18u);
    const AtlasStatistics statistics = measureAtlas(scene, buildAtlas(scene, result.size), result.size);
    EXPECT_NEAR(statistics.texelDensityMin, 20.0, 0.01);
    EXPECT_NEAR(statistics.texelDensityMax, 20.0, 0.01);
}

TEST(Unwrap, SizeForADensity) {
    // 100 m^2 at 4 texels/m are 1600 texels, at a coverage of 0.5 those of 56.6 x 56.6.
    EXPECT_EQ(sizeForDensity(100, 4, 0.5, 4096), 64u);
    EXPECT_EQ(sizeForDensity(100, 4, 0.25, 4096), 128u); // 80 x 80
    EXPECT_EQ(sizeForDensity(65536, 4, 1.0, 4096), 1024u);
    EXPECT_EQ(sizeForDensity(65537, 4, 1.0, 4096), 2048u);
    EXPECT_EQ(sizeForDensity(1e9, 4, 0.9, 4096), 4096u);
    EXPECT_EQ(sizeForDensity(1e9, 4, 0.9, 3000), 3000u);
    EXPECT_EQ(sizeForDensity(0, 4, 0.9, 4096), 64u);
    EXPECT_EQ(sizeForDensity(100, 0, 0.9, 4096), 64u);
    EXPECT_EQ(sizeForDensity(100, 4, 0, 4096), 4096u);
    EXPECT_EQ(sizeForDensity(std::numeric_limits<double>::infinity(), 4, 0.9, 4096), 4096u);
    EXPECT_EQ(sizeForDensity(std::nan(""), 4, 0.9, 4096), 4096u);
    EXPECT_EQ(sizeForDensity(100, 4, 0.5, 32), 32u);
    EXPECT_EQ(sizeForDensity(65537, 4, 1.0, 4096, 512), 1536u);
    EXPECT_EQ(sizeForDensity(65537, 4, 1.0, 1200, 512), 1200u);
    EXPECT_EQ(sizeForDensity(100, 4, 0.25, 4096, 512), 128u) << "the power of two is smaller";
    EXPECT_EQ(sizeForDensity(1e9, 4, 0.9, 4096, 512), 4096u);
}

TEST(Unwrap, AbsurdDensityIsAnError) {
    Scene scene = test::sceneOf(test::cube());
    EXPECT_THROW(unwrap(scene, {.density = 1e9, .size = 0}), Error);
    EXPECT_THROW(unwrap(scene, {.density = 0, .size = 0}), Error);
    EXPECT_LT(unwrap(scene, withDensity(1e9)).density, 512.0); // what fits
}

TEST(Unwrap, ReferenceScenesWithoutTheirUvs) {
    const std::string folder = std::string(RELUME_SHARED_DIR) + "/scenes/rtrad/";
    if (!std::filesystem::exists(folder + "Multilayer.glb"))
        GTEST_SKIP() << "no " << folder << " here: the reference scenes are not part of the project";
    for (const char* name : {"CornellLucy", "CornellGeom", "Multilayer", "Nvidia_Scene", "TextureScene"}) {
        Scene scene = loadGltf(folder + name + ".glb");
        for (Mesh& mesh : scene.meshes)
            for (Primitive& primitive : mesh.primitives)
                primitive.texCoord1.clear();
        expectValid(scene, {.onlyMissing = false}, name);
    }
}

} // namespace
} // namespace relume
