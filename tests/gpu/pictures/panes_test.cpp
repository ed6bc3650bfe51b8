// Light passes panes as though they were not there, in every tracer and through edits; pictures show what is
// behind them.
#include "assets/atlas/lightmap_atlas.h"
#include "assets/model/panes.h"
#include "renderer/picker.h"
#include "renderer/picture.h"
#include "renderer/tile_ids.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/layered.h"
#include "tests/gpu/wall_scene.h"

#include <gtest/gtest.h>

#include <numeric>

namespace relume {
namespace {

enum class Front { Open, Glass, Board };

Material glass(float alpha) {
    Material material = grey(0.0f);
    material.alphaMode = AlphaMode::Blend;
    material.baseColor.a = alpha;
    return material;
}

/// Makes a room of 2 m whose front, at z = 2, is open, a pane or a board; a sun and a sky shine into it.
Scene behind(Front front) {
    SceneMaker maker(64);
    const int wall = maker.material(0.6f);
    const glm::vec3 x = 2.0f * kX, y = 2.0f * kY, z = 2.0f * kZ, origin(0.0f);
    const glm::uvec2 texels(16);
    maker.quad(origin, x, y, wall, texels); // faces +z, as the rest faces inwards
    maker.quad(origin, z, x, wall, texels);
    maker.quad(origin, y, z, wall, texels);
    maker.quad({2, 0, 0}, z, y, wall, texels);
    maker.quad({0, 2, 0}, x, z, wall, texels);
    if (front != Front::Open)
        maker.quad({0, 0, 2}, y, x, front == Front::Glass ? maker.material(glass(0.3f)) : wall, texels);
    Scene scene = maker.scene();
    scene.sky.radiance = {0.5f, 0.7f, 1.0f};
    scene.lights.push_back(lightAt(LightType::Directional, {0, 0, 5}, 3.0f, "Sun"));
    markPanes(scene);
    return scene;
}

constexpr BakeDesc kWindow{.passes = 4, .method = Method::Hybrid, .samples = 16};

double meanOf(const FloatImage& image) {
    const std::vector<float>& green = image.planes[1];
    return std::accumulate(green.begin(), green.end(), 0.0) / static_cast<double>(green.size());
}

TEST(Panes, ARoomBehindOneIsLitAsThoughItWereNotThere) {
    for (const TracerKind tracer : tracersOfTestDevice()) {
        BakeDesc desc = kWindow;
        desc.tracer = tracer;
        const Baked open = bakeScene(behind(Front::Open), desc);
        const Baked glazed = bakeScene(behind(Front::Glass), desc);
        EXPECT_GT(meanOf(open.lighting), 0.1);
        EXPECT_EQ(glazed.patches.count, open.patches.count);
        for (size_t channel = 0; channel < open.lighting.planes.size(); ++channel)
            EXPECT_EQ(glazed.lighting.planes[channel], open.lighting.planes[channel]) << channel;
    }
    EXPECT_LT(meanOf(bakeScene(behind(Front::Board), kWindow).lighting),
              0.01 * meanOf(bakeScene(behind(Front::Open), kWindow).lighting));
}

TEST(Panes, OneThatIsMovedAndHiddenChangesNoLight) {
    Layered bake(behind(Front::Glass));
    const LightmapAtlas atlas = buildAtlas(bake.scene, 64);
    bake.finish();
    const Light4 before = bake.light();
    Instance& pane = bake.scene.instances.back();
    pane.transform[3].z = -1.0f; // into the middle of the room
    bake.editNow({}, &atlas);
    bake.finish();
    EXPECT_EQ(bake.light(), before);
    pane.hidden = true;
    bake.editNow({}, &atlas);
    bake.finish();
    EXPECT_EQ(bake.light(), before);
}

/// Makes a wall and in front of it a black pane of this alpha.
Scene wallBehindGlass(float alpha) {
    SceneMaker maker(kWallSize);
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(0.8f), {32, 32});
    maker.quad({-1, -1, 1}, {1, 0, 0}, {0, 2, 0}, maker.material(glass(alpha)), {16, 16});
    Scene scene = maker.scene();
    markPanes(scene);
    return scene;
}

TEST(Panes, PicturesShowWhatIsBehind) {
    const FloatImage lightmap = lightmapOf(0.5f);
    const Scene scene = wallBehindGlass(0.25f);
    const Picture picture = drawPicture({scene, &lightmap, before(), plain()});
    EXPECT_EQ(picture.pixel(48, 32), glm::ivec3(encoded(0.4)));
    EXPECT_NEAR(picture.pixel(16, 32).r, 0.75 * encoded(0.4), 1.0) << "a black pane takes its alpha away";
    const Scene clear = wallBehindGlass(0.0f);
    EXPECT_NEAR(drawPicture({clear, &lightmap, before(), plain()}).pixel(16, 32).r, 0.92 * encoded(0.4), 1.0)
        << "a clear one shows a little";
}

TEST(Panes, CanBePickedAndHideNoTiles) {
    testContext();
    const Scene scene = wallBehindGlass(0.25f);
    const SceneGpu gpu(scene, flatten(scene, buildAtlas(scene, kWallSize)));
    Picker picker;
    const auto at = [&](float x) { return picker.pick({gpu, before(), {x, 32}, {64, 64}, kWallSize}); };
    ASSERT_TRUE(at(16));
    EXPECT_EQ(at(16)->instance, 1u);
    EXPECT_FALSE(at(16)->lightmapUv) << "it has no light of its own";
    ASSERT_TRUE(at(48));
    EXPECT_EQ(at(48)->instance, 0u);
    Scene bare = wallBehindGlass(0.25f);
    bare.instances.pop_back();
    const SceneGpu wallAlone(bare, flatten(bare, buildAtlas(bare, kWallSize)));
    const auto tilesOf = [](const SceneGpu& seen) {
        TileIds ids;
        ids.request(seen, before(), 1.0f, kWallSize);
        std::optional<std::vector<uint32_t>> tiles;
        while (!tiles) {
            glFinish();
            tiles = ids.poll();
        }
        return *tiles;
    };
    EXPECT_EQ(tilesOf(gpu), tilesOf(wallAlone));
    EXPECT_EQ(tilesOf(gpu).size(), 16u) << "all 4 x 4 tiles of the wall";
}

} // namespace
} // namespace relume
