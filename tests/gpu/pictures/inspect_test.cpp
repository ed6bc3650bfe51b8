// This tests quantities that the baker put in the lightmap's place, on the model and as texture, and what is
// seen and clicked at.
#include "renderer/picker.h"
#include "renderer/picture.h"
#include "renderer/tile_ids.h"
#include "renderer/uv_view.h"
#include "tests/gpu/wall_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <set>
#include <thread>

namespace relume {
namespace {

glm::ivec3 bytes(const glm::vec3& displayed) {
    return glm::ivec3(glm::round(255.0f * displayed));
}

void expectNear(const glm::ivec3& a, const glm::ivec3& b, int tolerance = 1) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

/// Draws the wall in a view that inspects; its lightmap holds `value` left and `other` right.
Picture inspect(const DrawSettings& settings, const glm::vec3& value, const glm::vec3& other) {
    const SceneMaker maker = wall(grey(0.5f));
    const FloatImage quantity =
        lightmapOf({value.x, value.y, value.z, 1}, {other.x, other.y, other.z, 1}, kWallSize / 2);
    return drawPicture({maker.scene(), &quantity, before(), settings});
}

TEST(Inspect, ShowsQuantitiesAsWhatTheyAre) {
    const LightmapFilter nearest = LightmapFilter::Nearest;
    const Picture raw = inspect(plain(View::InspectRaw, nearest), {0.25f, 0.5f, 0.75f}, {1, 0, 0});
    expectNear(raw.pixel(8, 32), bytes({0.25f, 0.5f, 0.75f}));
    expectNear(raw.pixel(56, 32), {255, 0, 0});
    const Picture light = inspect(plain(View::InspectColor, nearest), {0.25f, 0.5f, 0.75f}, {1, 0, 0});
    expectNear(light.pixel(8, 32), {encoded(0.25), encoded(0.5), encoded(0.75)});
    const Picture normal = inspect(plain(View::InspectNormal, nearest), {-1, 0, 0}, {0, 0, 1});
    expectNear(normal.pixel(8, 32), {0, 128, 128});
    expectNear(normal.pixel(56, 32), {128, 128, 255});
    DrawSettings position = plain(View::InspectPosition, nearest);
    position.rangeLow = {-2, 0, 10};
    position.rangeHigh = {2, 4, 20};
    const Picture where = inspect(position, {-1, 3, 15}, {9, -9, 10});
    expectNear(where.pixel(8, 32), bytes({0.25f, 0.75f, 0.5f}));
    expectNear(where.pixel(56, 32), {255, 0, 0});
}

TEST(Inspect, ScalesHeatByTheRange) {
    DrawSettings heat = plain(View::InspectHeat, LightmapFilter::Nearest);
    heat.rangeLow.x = 2;
    heat.rangeHigh.x = 6;
    const Picture picture = inspect(heat, glm::vec3(3, 0, 0), glm::vec3(99, 0, 0));
    expectNear(picture.pixel(8, 32), bytes(shader::heatColor(0.25f)));
    expectNear(picture.pixel(56, 32), bytes(shader::heatColor(1.0f)));
}

TEST(Inspect, TellsLeavesAndSeenPatches) {
    const LightmapFilter nearest = LightmapFilter::Nearest;
    const Picture leaves = inspect(plain(View::InspectLeaves, nearest), {2, 0, 0.5f}, {2, 1, 0.5f});
    EXPECT_GT(leaves.pixel(8, 32).r + leaves.pixel(8, 32).g + leaves.pixel(8, 32).b,
              leaves.pixel(56, 32).r + leaves.pixel(56, 32).g + leaves.pixel(56, 32).b + 60); // a border
    const Picture mask = inspect(plain(View::InspectMask, nearest), {1, 1, 0}, {0, 0, 0});
    EXPECT_GT(mask.pixel(8, 32).r, mask.pixel(56, 32).r + 100);
    const Picture faint = inspect(plain(View::InspectMask, nearest), {1, 0.01f, 0}, {1, 0, 1});
    EXPECT_LT(faint.pixel(8, 32).r, mask.pixel(8, 32).r - 50);
    EXPECT_GT(faint.pixel(56, 32).b, faint.pixel(56, 32).g + 60); // seen from here
}

TEST(Inspect, LeavesGeometryWithoutLightmapUvsApart) {
    SceneMaker maker(kWallSize);
    maker.quad({-1, 5, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(0.5f),
               {kWallSize, kWallSize}); // out of sight
    maker.blocker({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(0.5f));
    const FloatImage quantity = lightmapOf(1.0f);
    expectNear(drawPicture({maker.scene(), &quantity, before(), plain(View::InspectRaw)}).pixel(32, 32),
               bytes({0.35f, 0.3f, 0.4f}));
}

class UvPicture {
public:
    UvPicture() : target({.width = 128, .height = 64, .name = "test"}) {
        settings.draw = plain(View::InspectRaw, LightmapFilter::Nearest);
        settings.draw.background = glm::vec3(0.0f);
    }
    Picture draw(const LightmapTexture& lightmap) {
        view.draw(lightmap, settings, {target.get(), target.width(), target.height()});
        return {readPicture(target), {}, 0};
    }

    const gl::HeadlessContext& context = testContext();
    UvView view;
    UvView::Settings settings;
    gl::Framebuffer target;
};

/// Makes red from 0 to 1 along the row and green along the column; the last row is empty.
FloatImage ramps() {
    FloatImage image = lightmapOf(1.0f);
    for (uint32_t i = 0; i < kWallSize * kWallSize; ++i) {
        image.planes[0][i] = static_cast<float>(i % kWallSize) / 64.0f;
        image.planes[1][i] = static_cast<float>(i / kWallSize) / 64.0f;
        if (i / kWallSize == kWallSize - 1) image.planes[3][i] = 0.0f;
    }
    return image;
}

TEST(UvView, ShowsRowZeroOnTopAndMasksEmptyTexels) {
    UvPicture uv;
    const LightmapImage image(ramps(), "test");
    Picture picture = uv.draw(image.texture()); // a pixel for each texel, in the middle of the target
    for (const glm::uvec2 texel : {glm::uvec2(0, 0), glm::uvec2(63, 0), glm::uvec2(5, 40)})
        expectNear(picture.pixel(32 + texel.x, texel.y),
                   bytes({static_cast<float>(texel.x) / 64, static_cast<float>(texel.y) / 64, 1}));
    EXPECT_EQ(picture.pixel(31, 20), glm::ivec3(0)); // beside it
    EXPECT_EQ(picture.pixel(96, 20), glm::ivec3(0));
    EXPECT_GT(picture.pixel(50, 63).r, 40); // hatched
    EXPECT_EQ(picture.pixel(50, 63).r, picture.pixel(50, 63).b);
    uv.settings.masked = false;
    picture = uv.draw(image.texture());
    EXPECT_EQ(picture.pixel(50, 63), glm::ivec3(0)); // what an empty texel holds
}

TEST(UvView, ZoomsAboutThePointerAndPans) {
    UvPicture uv;
    const LightmapImage image(ramps(), "test");
    const glm::vec2 size(128, 64);
    const glm::vec2 pointer(52.5f, 10.5f);
    const glm::vec2 before = uvAt(uv.settings.window, pointer, size);
    expectNear({static_cast<int>(before.x * 64), static_cast<int>(before.y * 64), 0}, {20, 10, 0}, 0);
    uv.settings.window = zoom(uv.settings.window, 8.0f, pointer, size);
    EXPECT_LT(glm::distance(uvAt(uv.settings.window, pointer, size), before), 1e-5f);
    expectNear(uv.draw(image.texture()).pixel(52, 10), bytes({20.0f / 64, 10.0f / 64, 1}));
    uv.settings.window = pan(uv.settings.window, {8, 0}, size); // by one texel to the right
    expectNear(uv.draw(image.texture()).pixel(52, 10), bytes({19.0f / 64, 10.0f / 64, 1}));
}

TEST(UvView, ExposesLightAsTheSceneDoes) {
    UvPicture uv;
    const LightmapImage image(lightmapOf(0.2f), "test");
    LightmapTexture lightmap = image.texture();
    lightmap.unit = 2.0f;
    uv.settings.draw.view = View::InspectColor;
    uv.settings.draw.exposure = 1.0f;
    EXPECT_EQ(uv.draw(lightmap).pixel(64, 32), glm::ivec3(encoded(0.8)));
    uv.settings.draw.view = View::Lit;
    EXPECT_EQ(uv.draw(lightmap).pixel(64, 32), glm::ivec3(encoded(0.8)));
    uv.settings.draw.background = glm::vec3(1.0f, 0.0f, 0.0f);
    EXPECT_EQ(uv.draw({}).pixel(64, 32), glm::ivec3(255, 0, 0)); // no texture yet
}

/// Makes a closed room of 2 m whose walls have charts of 16 x 16 texels.
struct Room {
    explicit Room(const Material& material = grey(0.5f)) : maker(kWallSize) {
        testContext();
        const int index = maker.material(material);
        walls = maker.box({-1, -1, -1}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}}, index, 16);
        gpu = std::make_unique<SceneGpu>(maker.scene(),
                                         flatten(maker.scene(), buildAtlas(maker.scene(), kWallSize)));
    }
    std::set<uint32_t> tilesOf(const TexelRect& rect) const {
        std::set<uint32_t> tiles;
        for (uint32_t y = rect.y; y < rect.y + rect.height; ++y)
            for (uint32_t x = rect.x; x < rect.x + rect.width; ++x)
                tiles.insert(y / 8 * (kWallSize / 8) + x / 8);
        return tiles;
    }

    SceneMaker maker;
    std::array<TexelRect, 6> walls{}; // at the start of x, y, z, then at the end
    std::unique_ptr<SceneGpu> gpu;
};

std::vector<uint32_t> seenTiles(TileIds& ids) {
    for (int i = 0; i < 5000; ++i) {
        if (std::optional<std::vector<uint32_t>> tiles = ids.poll()) return *tiles;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "never arrived";
    return {};
}

TEST(TileIds, TellsWhatTheCameraSees) {
    const Room room;
    ViewCamera camera = cameraAt({0, 0, 0}, {0.1f, 0, -1}, room.gpu->bounds());
    camera.yfov = 1.7f; // all of a wall
    TileIds ids;
    EXPECT_FALSE(ids.poll());
    ids.request(*room.gpu, camera, 1.5f, kWallSize);
    EXPECT_TRUE(ids.pending());
    const std::vector<uint32_t> tiles = seenTiles(ids);
    EXPECT_FALSE(ids.poll());
    const std::set<uint32_t> seen(tiles.begin(), tiles.end());
    EXPECT_EQ(seen.size(), tiles.size());
    EXPECT_TRUE(std::is_sorted(tiles.begin(), tiles.end()));
    // Charts may share the tiles at their borders; these are the tiles of only the wall behind.
    std::set<uint32_t> behind = room.tilesOf(room.walls[5]);
    for (size_t i = 0; i < 5; ++i)
        for (const uint32_t tile : room.tilesOf(room.walls[i]))
            behind.erase(tile);
    ASSERT_FALSE(behind.empty());
    for (const uint32_t tile : behind)
        EXPECT_EQ(seen.count(tile), 0u) << tile;
    const TexelRect& ahead = room.walls[2];
    EXPECT_EQ(seen.count((ahead.y + 8) / 8 * (kWallSize / 8) + (ahead.x + 8) / 8), 1u);
    camera.target = -camera.target; // turned round
    ids.request(*room.gpu, camera, 1.5f, kWallSize);
    const std::vector<uint32_t> turned = seenTiles(ids);
    for (const uint32_t tile : behind)
        EXPECT_TRUE(std::binary_search(turned.begin(), turned.end(), tile)) << tile;
}

TEST(Picker, FindsTheSurfaceUnderAPixel) {
    const Room room;
    ViewCamera camera = cameraAt({0, 0, 0}, {0, 0, -1}, room.gpu->bounds());
    camera.yfov = glm::radians(60.0f);
    Picker picker;
    const glm::vec2 size(300, 200), pixel(170, 60);
    const std::optional<Pick> pick = picker.pick({*room.gpu, camera, pixel, size, kWallSize});
    ASSERT_TRUE(pick);
    // The ray through the pixel meets the wall at z = -1.
    const float half = std::tan(0.5f * camera.yfov);
    const glm::vec2 ndc(2 * pixel.x / size.x - 1, 1 - 2 * pixel.y / size.y);
    const glm::vec3 expected(ndc.x * half * 1.5f, ndc.y * half, -1.0f);
    EXPECT_LT(glm::distance(pick->position, expected), 1e-4f);
    EXPECT_EQ(pick->instance, 4u); // start and end of x, of y, then of z
    EXPECT_EQ(pick->material, 0u);
    ASSERT_TRUE(pick->lightmapUv);
    const TexelRect& rect = room.walls[2];
    EXPECT_GE(pick->texel.x, rect.x);
    EXPECT_LT(pick->texel.x, rect.x + rect.width);
    EXPECT_GE(pick->texel.y, rect.y);
    EXPECT_LT(pick->texel.y, rect.y + rect.height);
}

TEST(Picker, TakesNothingForBacksHolesAndEmptiness) {
    SceneMaker maker(kWallSize);
    Material masked = grey(1.0f);
    masked.alphaMode = AlphaMode::Mask;
    masked.baseColorTexture.texture = maker.alphaTexture(2, 1, {0, 255});
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(masked), {16, 16});
    maker.blocker({-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, maker.material(0.5f)); // behind the hole's lower half
    testContext();
    const SceneGpu gpu(maker.scene(), flatten(maker.scene(), buildAtlas(maker.scene(), kWallSize)));
    Picker picker;
    const auto at = [&](float x, float y, float z) {
        return picker.pick({gpu, before(z), {x, y}, {64, 64}, kWallSize});
    };
    EXPECT_FALSE(at(16, 16, 5)); // through the hole
    ASSERT_TRUE(at(48, 16, 5));
    EXPECT_EQ(at(48, 16, 5)->instance, 0u);
    const std::optional<Pick> blocker = at(16, 48, 5);
    ASSERT_TRUE(blocker);
    EXPECT_EQ(blocker->instance, 1u);
    EXPECT_FALSE(blocker->lightmapUv);
    EXPECT_NEAR(blocker->position.z, -1.0f, 1e-4f);
    EXPECT_FALSE(at(48, 16, -5)); // its back
}

} // namespace
} // namespace relume
