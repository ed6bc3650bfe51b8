// Panes are what light passes: which materials they are, and that they are drawn and not baked.
#include "assets/model/panes.h"

#include "assets/atlas/world_mesh.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

Material blended(float alpha) {
    Material material;
    material.alphaMode = AlphaMode::Blend;
    material.baseColor.a = alpha;
    return material;
}

TEST(Panes, AreWhatBlendsBelowOneHalf) {
    EXPECT_TRUE(passesLight(blended(0.49f), 1.0f));
    EXPECT_FALSE(passesLight(blended(0.5f), 1.0f));
    EXPECT_TRUE(passesLight(blended(0.9f), 0.5f)) << "by its texture";
    EXPECT_FALSE(passesLight(blended(0.9f), 0.6f));
    Material opaque = blended(0.1f);
    opaque.alphaMode = AlphaMode::Opaque;
    EXPECT_FALSE(passesLight(opaque, 0.1f)) << "alpha means nothing there";
    opaque.alphaMode = AlphaMode::Mask;
    EXPECT_FALSE(passesLight(opaque, 0.1f)) << "the tracers cut its holes";
}

TEST(Panes, AreWhatTransmitsMoreThanOneHalf) {
    Material glass;
    glass.transmission = 0.5f;
    EXPECT_FALSE(passesLight(glass, 1.0f));
    glass.transmission = 0.51f;
    EXPECT_TRUE(passesLight(glass, 1.0f));
    glass.emission = glm::vec3(0.0f, 0.1f, 0.0f);
    EXPECT_FALSE(passesLight(glass, 1.0f)) << "its light would be lost";
}

TEST(Panes, TheMeanOfAChannelIsThatOfAllPixels) {
    EXPECT_EQ(meanOfChannel({"", 2, 1, {255, 0, 51, 0, 255, 0, 0, 102}}, 0), 1.0);
    EXPECT_NEAR(meanOfChannel({"", 2, 1, {255, 0, 51, 0, 255, 0, 0, 102}}, 2), 0.1, 1e-12);
    EXPECT_NEAR(meanOfChannel({"", 2, 1, {255, 0, 51, 0, 255, 0, 0, 102}}, 3), 0.2, 1e-12);
    EXPECT_EQ(meanOfChannel({}, 3), 1.0);
}

/// A wall of material 0 and a pane of material 1, whose texture is half clear.
Scene wallAndPane() {
    Scene scene;
    scene.materials = {Material(), blended(0.9f)};
    scene.images.push_back({"", 2, 1, {255, 255, 255, 255, 255, 255, 255, 0}});
    scene.textures.push_back({.image = 0});
    scene.materials[1].baseColorTexture.texture = 0;
    for (const int material : {0, 1}) {
        Primitive square = test::square();
        square.material = material;
        test::addInstance(scene, test::addMesh(scene, square));
    }
    return scene;
}

LightmapAtlas wholeAtlas(const Scene& scene) {
    LightmapAtlas atlas;
    atlas.instances.assign(scene.instances.size(), {glm::vec2(1.0f), glm::vec2(0.0f), 1});
    return atlas;
}

TEST(Panes, AreMarkedByTheirTextureAndLeftOutOfTheBake) {
    Scene scene = wallAndPane();
    markPanes(scene);
    EXPECT_FALSE(scene.materials[0].pane);
    EXPECT_TRUE(scene.materials[1].pane);
    const WorldMesh mesh = flatten(scene, wholeAtlas(scene));
    EXPECT_EQ(mesh.material, (std::vector<uint32_t>{0, 0}));
    EXPECT_EQ(mesh.opaqueCount, 2u);
    EXPECT_EQ(mesh.chartCount, 1u);
    const WorldMesh panes = flattenPanes(scene);
    EXPECT_EQ(panes.material, (std::vector<uint32_t>{1, 1}));
    EXPECT_EQ(panes.instance, (std::vector<uint32_t>{1, 1}));
    EXPECT_EQ(panes.chart, (std::vector<uint32_t>{kNoChart, kNoChart}));
    EXPECT_EQ(panes.lightmapUv.size(), 6u);
    scene.instances[1].hidden = true;
    EXPECT_EQ(flattenPanes(scene).triangleCount(), 0u);
}

TEST(Panes, AVaseByItselfIsNone) {
    Scene scene = wallAndPane();
    scene.instances.erase(scene.instances.begin());
    markPanes(scene);
    EXPECT_FALSE(scene.materials[1].pane);
    EXPECT_EQ(flatten(scene, wholeAtlas(scene)).triangleCount(), 2u);
    scene = wallAndPane();
    scene.instances[0].hidden = true;
    markPanes(scene);
    EXPECT_FALSE(scene.materials[1].pane) << "all else is hidden";
}

} // namespace
} // namespace relume
