// Parts of a lightmap's texture group are held against the whole.
#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/world_mesh.h"
#include "assets/base/worker_pool.h"
#include "bake/surface/cit_pass.h"
#include "bake/surface/patches.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/log_capture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace relume {
namespace {

constexpr uint32_t kGroupSize = 64;

// Makes a room of odd places and sizes, so that rounding shows.
Scene groupRoom() {
    SceneMaker maker(kGroupSize);
    maker.box({0.13f, -0.77f, 0.31f}, {1.93f * kX, 2.17f * kY, 1.71f * kZ}, maker.material(0.6f), 13);
    maker.quad({0.61f, 0.63f, 1.87f}, 0.41f * kY, 0.37f * kX, maker.material(0.3f, 7.0f), glm::uvec2(5));
    maker.disc({1.1f, 0.7f, 0.9f}, 0.31f * kX, 0.23f * kY, maker.material(0.4f), 11);
    return maker.scene();
}

template<typename T>
bool same(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(a)) == 0;
}

template<class T>
void expectSameMemory(const std::vector<T>& a, const std::vector<T>& b, const char* what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0) << what;
}

} // namespace

TEST(TextureGroup, AWindowHasTheTexelsOfTheWhole) {
    const Scene scene = groupRoom();
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kGroupSize));
    CitPass pass(testDevice(), scene, mesh);
    EXPECT_TRUE(pass.serves(mesh));
    for (const bool conservative : {false, true}) {
        const TextureGroup whole = rasterizeTextureGroup(testDevice(), scene, mesh,
                                                         {.size = kGroupSize, .conservative = conservative});
        ASSERT_EQ(whole.pos.size(), size_t{kGroupSize} * kGroupSize);
        for (const TexelWindow& window :
             {TexelWindow{8, 16, 24, 8}, TexelWindow{0, 0, 64, 16}, TexelWindow{40, 0, 24, 64}}) {
            const TextureGroup part =
                pass.draw(scene, mesh, {.size = kGroupSize, .conservative = conservative, .window = window});
            ASSERT_EQ(part.triangle.size(), window.size());
            uint32_t covered = 0;
            for (uint32_t y = window.row; y < window.row + window.rows; ++y)
                for (uint32_t x = window.column; x < window.column + window.columns; ++x) {
                    const size_t in = window.index(x, y), of = size_t{y} * kGroupSize + x;
                    ASSERT_EQ(part.triangle[in], whole.triangle[of]) << x << ", " << y;
                    ASSERT_TRUE(same(part.pos[in], whole.pos[of]) && same(part.nrm[in], whole.nrm[of]) &&
                                same(part.mat[in], whole.mat[of]) &&
                                same(part.emission[in], whole.emission[of]))
                        << x << ", " << y;
                    covered += part.triangle[in] != 0;
                }
            EXPECT_GT(covered, 0u);
        }
    }
}

// A pass that stays is told of factors, and tells whose materials it does not have.
TEST(TextureGroup, APassThatStaysFollowsFactorsOfMaterials) {
    Scene scene = groupRoom();
    const LightmapAtlas atlas = buildAtlas(scene, kGroupSize);
    const WorldMesh mesh = flatten(scene, atlas);
    CitPass pass(testDevice(), scene, mesh);
    pass.draw(scene, mesh, {.size = kGroupSize});
    for (Material& material : scene.materials) {
        material.metallic = 0.5f;
        material.roughness = 0.25f;
    }
    const TextureGroup kept = pass.draw(scene, mesh, {.size = kGroupSize});
    const TextureGroup anew = rasterizeTextureGroup(testDevice(), scene, mesh, {.size = kGroupSize});
    for (size_t i = 0; i < anew.mat.size(); ++i)
        ASSERT_EQ(kept.mat[i], anew.mat[i]);
    const std::vector<uint32_t> plate = {6};
    EXPECT_FALSE(pass.serves(flattenInstances(scene, atlas, plate)));
}

// A valid image may be larger than the device's: it is made smaller, which one line tells.
TEST(TextureGroup, AnImageThatIsTooLargeForTheDeviceIsMadeSmaller) {
    SceneMaker maker(kGroupSize);
    Material material;
    material.metallic = 0.0f;
    material.baseColorTexture.texture = maker.alphaTexture(2, 1, {255, 255});
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(material), {kGroupSize, kGroupSize});
    Scene scene = maker.scene();
    scene.path = "wide.glb";
    const auto paint = [&scene](uint32_t width) { // the left half in one colour, the right one in another
        Image& image = scene.images[0];
        image.width = width;
        image.rgba.clear();
        for (uint32_t x = 0; x < width; ++x) {
            const auto pixel = 2 * x < width ? std::array<uint8_t, 4>{200, 100, 50, 255}
                                             : std::array<uint8_t, 4>{10, 20, 250, 255};
            image.rgba.insert(image.rgba.end(), pixel.begin(), pixel.end());
        }
    };
    const auto rasterized = [&scene] {
        return rasterizeTextureGroup(testDevice(), scene, flatten(scene, buildAtlas(scene, kGroupSize)),
                                     {.size = kGroupSize});
    };
    paint(2);
    const LogCapture log;
    const TextureGroup wanted = rasterized();
    EXPECT_EQ(log.text(), "");
    const uint32_t most = testDevice().limits().maxImageDimension2D;
    paint(most);
    rasterized();
    EXPECT_EQ(log.text(), "");
    paint(most + most / 4);
    const TextureGroup group = rasterized();
    for (const uint32_t column : {kGroupSize / 4, kGroupSize * 3 / 4})
        for (uint32_t row = 0; row < kGroupSize; ++row) {
            const size_t texel = size_t{row} * kGroupSize + column;
            for (glm::length_t c = 0; c < 3; ++c)
                ASSERT_NEAR(group.mat[texel][c], wanted.mat[texel][c], 0.002f) << column << ", " << row;
        }
    const std::string text = log.text();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_NE(text.find("wide.glb: image 0 'alpha': has " + std::to_string(most + most / 4) + " x 1 pixels"),
              std::string::npos)
        << text;
}

// The patches of a window are those of the whole that lie in it.
TEST(TextureGroup, PatchesOfAWindowAreThoseOfTheWhole) {
    const Scene scene = groupRoom();
    const LightmapAtlas atlas = buildAtlas(scene, kGroupSize);
    const WorldMesh mesh = flatten(scene, atlas);
    const PatchSet whole =
        buildPatches(scene, mesh, rasterizeTextureGroup(testDevice(), scene, mesh, {.size = kGroupSize}), {});
    const TexelWindow window{24, 8, 40, 32};
    const TextureGroup group =
        rasterizeTextureGroup(testDevice(), scene, mesh, {.size = kGroupSize, .window = window});
    const PatchSet part = buildPatches(scene, mesh, group, {.part = true});
    ASSERT_EQ(part.scene.texelToPatch.size(), window.size());
    uint32_t found = 0;
    for (uint32_t y = window.row; y < window.row + window.rows; ++y)
        for (uint32_t x = window.column; x < window.column + window.columns; ++x) {
            const uint32_t own = part.scene.texelToPatch[window.index(x, y)];
            const uint32_t other = whole.scene.texelToPatch[size_t{y} * kGroupSize + x];
            ASSERT_EQ(own == shader::kNoPatch, other == shader::kNoPatch);
            if (own == shader::kNoPatch) continue;
            EXPECT_EQ(part.scene.patches[own].position, whole.scene.patches[other].position);
            EXPECT_EQ(part.scene.patches[own].flags, whole.scene.patches[other].flags);
            ++found;
        }
    EXPECT_GT(found, 100u);
    EXPECT_EQ(part.count, found);
}

// Patches are built on all cores; which of them does what decides nothing.
TEST(TextureGroup, ThreadsMakeNoOtherPatches) {
    Scene scene = groupRoom();
    scene.materials[0].doubleSided = true; // its backs are patches, too
    scene.materials[0].emission = glm::vec3(3.0f);
    const WorldMesh mesh = flatten(scene, buildAtlas(scene, kGroupSize));
    const TextureGroup group = rasterizeTextureGroup(testDevice(), scene, mesh, {.size = kGroupSize});
    const PatchSet alone = buildPatches(scene, mesh, group, {});
    EXPECT_TRUE(std::any_of(alone.scene.patches.begin(), alone.scene.patches.end(),
                            [](const auto& patch) { return (patch.flags & shader::kPatchBackSide) != 0; }));
    for (const uint32_t threads : {1u, 2u, 7u}) {
        WorkerPool pool(threads);
        const PatchSet shared = buildPatches(scene, mesh, group, {.pool = &pool});
        EXPECT_EQ(shared.count, alone.count);
        EXPECT_EQ(shared.clampedAlbedo, alone.clampedAlbedo);
        expectSameMemory(shared.scene.patches, alone.scene.patches, "patches");
        expectSameMemory(shared.scene.patchChart, alone.scene.patchChart, "charts");
        expectSameMemory(shared.scene.texelToPatch, alone.scene.texelToPatch, "texels");
        expectSameMemory(shared.scene.hitTriangles, alone.scene.hitTriangles, "triangles");
        expectSameMemory(shared.edges, alone.edges, "edges");
        expectSameMemory(shared.covers, alone.covers, "covers");
        expectSameMemory(shared.coverCells, alone.coverCells, "cells");
        expectSameMemory(shared.reach, alone.reach, "reach");
        expectSameMemory(shared.bounds, alone.bounds, "bounds");
        expectSameMemory(shared.albedo, alone.albedo, "albedo");
        expectSameMemory(shared.emission, alone.emission, "emission");
        expectSameMemory(shared.material, alone.material, "materials");
        expectSameMemory(shared.instance, alone.instance, "instances");
    }
}

} // namespace relume
