// Texels of masked surfaces: what is solid in them, of which colour, and where their own point lies.
#include "assets/atlas/lightmap_atlas.h"
#include "assets/base/worker_pool.h"
#include "bake/surface/masked_texels.h"
#include "bake/surface/patches.h"

#include <gtest/gtest.h>

#include <cstring>

namespace relume {
namespace {

constexpr uint32_t kMaskMap = 16; // edge of the lightmap, which a square of 1 m covers [texels]

// Makes a masked square of 1 m with a texture of so many texels squared, solid where `isSolid` says so. What
// is solid is green and shines green; holes are white.
template<class IsSolid>
Scene maskedSquare(uint32_t edge, const IsSolid& isSolid) {
    Scene scene;
    Primitive square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.normals.assign(4, glm::vec3(0, 0, 1));
    square.texCoord0 = square.texCoord1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    square.indices = {0, 1, 2, 0, 2, 3};
    square.material = 0;
    scene.meshes.push_back({"Square", {square}});
    scene.instances.push_back({"Square", 0});
    Image image{"mask", edge, edge, {}};
    for (uint32_t y = 0; y < edge; ++y)
        for (uint32_t x = 0; x < edge; ++x) {
            const uint8_t hole = isSolid(x, y) ? 0 : 255;
            image.rgba.insert(image.rgba.end(), {hole, 255, hole, static_cast<uint8_t>(255 - hole)});
        }
    scene.images.push_back(image);
    scene.textures.push_back({.image = 0});
    Material material;
    material.metallic = 0.0f;
    material.emission = glm::vec3(1.0f);
    material.alphaMode = AlphaMode::Mask;
    material.baseColorTexture.texture = material.emissionTexture.texture = 0;
    scene.materials.push_back(material);
    return scene;
}

// Draws the square as the CIT pass does.
TextureGroup drawnSquare() {
    TextureGroup group;
    group.size = kMaskMap;
    group.window = {0, 0, kMaskMap, kMaskMap};
    for (uint32_t y = 0; y < kMaskMap; ++y)
        for (uint32_t x = 0; x < kMaskMap; ++x) {
            group.pos.emplace_back((x + 0.5f) / kMaskMap, (y + 0.5f) / kMaskMap, 0.0f, 1.0f);
            group.nrm.emplace_back(0.0f, 0.0f, 1.0f, 0.0f);
            group.mat.emplace_back(0.5f);
            group.emission.emplace_back(0.5f);
            group.triangle.push_back(x >= y ? 1u : 2u);
        }
    return group;
}

TextureGroup searched(const Scene& scene, const WorldMesh& mesh, uint32_t threads = 1) {
    TextureGroup group = drawnSquare();
    WorkerPool pool(threads);
    findSolidTexels(group, scene, mesh, pool);
    return group;
}

bool stripes(uint32_t x, uint32_t) {
    return x % 10 < 3;
}

} // namespace

// The mask's texels are finer than those of the lightmap, and a mean of their alpha is below the cutoff.
TEST(MaskedTexels, HaveThePartThatIsSolid) {
    const Scene scene = maskedSquare(200, stripes);
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kMaskMap));
    const TextureGroup group = searched(scene, mesh);
    double sum = 0;
    for (uint32_t y = 0; y < kMaskMap; ++y)
        for (uint32_t x = 0; x < kMaskMap; ++x) {
            const size_t at = group.window.index(x, y);
            ASSERT_NE(group.triangle[at], 0u) << x << ", " << y;
            uint32_t solid = 0; // of 25 columns of halves of the mask's texels
            for (uint32_t k = 0; k < 25; ++k)
                solid += stripes((25 * x + k) / 2, 0) ? 1u : 0u;
            EXPECT_NEAR(group.solid[at], solid / 25.0, 0.06) << x << ", " << y;
            EXPECT_EQ(glm::vec3(group.mat[at]), glm::vec3(0, 1, 0));
            EXPECT_EQ(glm::vec3(group.emission[at]), glm::vec3(0, 1, 0));
            const auto column = static_cast<uint32_t>(group.pos[at].x * 200.0f);
            EXPECT_TRUE(stripes(column, 0)) << x << ", " << y << " lies in column " << column;
            EXPECT_NEAR(group.pos[at].x, (x + 0.5) / kMaskMap, 0.5 / kMaskMap);
            EXPECT_NEAR(group.pos[at].y, (y + 0.5) / kMaskMap, 0.5 / kMaskMap);
            EXPECT_EQ(group.pos[at].z, 0.0f);
            EXPECT_EQ(glm::vec3(group.nrm[at]), glm::vec3(0, 0, 1));
            sum += group.solid[at];
        }
    EXPECT_NEAR(sum / (kMaskMap * kMaskMap), 0.3, 0.003);
}

TEST(MaskedTexels, AreEmptyWhereNothingIsSolid) {
    const Scene scene = maskedSquare(4, [](uint32_t x, uint32_t y) { return x == 1 && y == 2; });
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kMaskMap));
    const TextureGroup group = searched(scene, mesh), drawn = drawnSquare();
    for (uint32_t y = 0; y < kMaskMap; ++y)
        for (uint32_t x = 0; x < kMaskMap; ++x) {
            const size_t at = group.window.index(x, y);
            const bool there = x / 4 == 1 && y / 4 == 2;
            EXPECT_EQ(group.solid[at], there ? 1.0f : 0.0f) << x << ", " << y;
            EXPECT_EQ(group.triangle[at], there ? drawn.triangle[at] : 0u);
            EXPECT_EQ(group.pos[at], there ? drawn.pos[at] : glm::vec4(0.0f)) << "a solid point stays";
        }
}

// A patch sends with what is solid of it; all patches together have what is solid of the chart.
TEST(MaskedTexels, GivePatchesTheirArea) {
    const Scene scene = maskedSquare(200, stripes);
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kMaskMap));
    const TextureGroup group = searched(scene, mesh);
    const PatchSet set = buildPatches(scene, mesh, group, {});
    ASSERT_EQ(set.count, kMaskMap * kMaskMap);
    double sum = 0;
    for (uint32_t i = 0; i < set.count; ++i) {
        const shader::Patch& patch = set.scene.patches[i];
        EXPECT_NEAR(glm::length(glm::cross(set.edges[i].du, set.edges[i].dv)), patch.area,
                    1e-4f * patch.area);
        sum += patch.area;
    }
    EXPECT_NEAR(sum, 0.3, 0.006);
}

TEST(MaskedTexels, DoNotDependOnThreads) {
    const Scene scene = maskedSquare(200, [](uint32_t x, uint32_t y) { return (x * 7 + y * 13) % 11 < 4; });
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kMaskMap));
    const TextureGroup alone = searched(scene, mesh);
    for (const uint32_t threads : {2u, 5u}) {
        const TextureGroup shared = searched(scene, mesh, threads);
        EXPECT_EQ(shared.triangle, alone.triangle);
        EXPECT_EQ(shared.solid, alone.solid);
        EXPECT_EQ(shared.pos, alone.pos);
        EXPECT_EQ(shared.mat, alone.mat);
        EXPECT_EQ(shared.emission, alone.emission);
    }
}

} // namespace relume
