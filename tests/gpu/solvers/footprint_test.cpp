// Here links read the light filtered over what their direction stands for.
#include "assets/generate/generate.h"
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace relume {
namespace {

// Makes a room whose floor shines in stripes two texels wide: fine detail, of which few directions catch more
// or less by chance.
Scene stripedRoom(uint32_t size) {
    SceneMaker maker(size);
    Material shining;
    shining.baseColor = glm::vec4(0.5f);
    shining.metallic = 0.0f;
    shining.emission = glm::vec3(1.0f);
    shining.emissionTexture.texture = 0;
    const int wall = maker.material(0.5f), floor = maker.material(shining);
    std::array<glm::uvec2, 6> texels;
    texels.fill(glm::uvec2(32));
    maker.box({0, 0, 0}, {4.0f * kX, 4.0f * kY, 4.0f * kZ}, {wall, floor, wall, wall, wall, wall}, texels);
    Scene scene = maker.scene();
    Image stripes{"stripes", 16, 1, {}};
    for (uint32_t x = 0; x < stripes.width; ++x) {
        const uint8_t value = x % 2 == 0 ? 255 : 0;
        stripes.rgba.insert(stripes.rgba.end(), {value, value, value, 255});
    }
    scene.images.push_back(stripes);
    scene.textures.push_back({.image = 0, .nearest = true});
    return scene;
}

struct FootprintCase {
    const char* name;
    BakeDesc desc;
};

} // namespace

class Footprint : public testing::TestWithParam<FootprintCase> {};
INSTANTIATE_TEST_SUITE_P(
    All, Footprint,
    testing::Values(FootprintCase{"directional", {.method = Method::Directional, .footprint = true}},
                    FootprintCase{"hybrid", {.method = Method::Hybrid, .footprint = true}},
                    FootprintCase{
                        "smoothCoarse",
                        {.method = Method::Hybrid, .smooth = true, .indirectScale = 2, .footprint = true}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_P(Footprint, FurnaceEndsAtTheSeriesLimit) {
    constexpr float kAlbedo = 0.5f;
    SceneMaker maker(64);
    const auto walls =
        maker.box({3, 1, -2}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(kAlbedo, 1.0f), 20);
    BakeDesc desc = GetParam().desc;
    desc.passes = 0;
    desc.error = 0.002;
    desc.samples = 1024;
    const Baked baked = bakeScene(maker.scene(), desc);
    for (const TexelRect& wall : walls) {
        const TexelStatistics s = statistics(baked.radiance, wall);
        EXPECT_NEAR(s.mean, 1.0 / (1.0 - kAlbedo), 0.004 / (1.0 - kAlbedo));
        EXPECT_GT(s.min, 0.97 / (1.0 - kAlbedo));
        EXPECT_LT(s.max, 1.03 / (1.0 - kAlbedo));
    }
}

// The cell's charts lie beside bright ones in the lightmap.
TEST_P(Footprint, ADarkCellStaysDark) {
    SceneMaker maker(128);
    maker.box({-1, -1, -1}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.8f, 1.0f), 19);
    const auto cell =
        maker.box({-0.3f, -0.3f, -0.3f}, {0.6f * kX, 0.6f * kY, 0.6f * kZ}, maker.material(0.8f), 11);
    BakeDesc desc = GetParam().desc;
    desc.size = maker.size();
    desc.passes = 3;
    desc.samples = 16;
    const Baked baked = bakeScene(maker.scene(), desc);
    for (const TexelRect& wall : cell)
        EXPECT_EQ(statistics(baked.lighting, wall).max, 0.0);
}

TEST_P(Footprint, CacheAndBatchesChangeNoByte) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc = GetParam().desc;
    desc.passes = 3;
    desc.samples = 32;
    const Baked first = bakeScene(scene, desc);
    EXPECT_GT(first.progress.raysSaved, 0u);
    desc.batchMs = 1;
    desc.cache.kind = CacheSettings::Kind::None;
    const Baked without = bakeScene(scene, desc);
    EXPECT_EQ(without.lighting.planes, first.lighting.planes);
    EXPECT_EQ(without.progress.raysSaved, 0u);
    desc.footprint = false;
    EXPECT_NE(bakeScene(scene, desc).lighting.planes, first.lighting.planes);
}

TEST_P(Footprint, KeepsTheFlux) {
    for (const char* name : {"cornell_small", "cornell_layers"}) {
        BakeDesc desc = GetParam().desc;
        desc.passes = 4;
        desc.samples = 64;
        const Scene scene = generateScene(name);
        const Baked with = bakeScene(scene, desc);
        desc.footprint = false;
        const Baked without = bakeScene(scene, desc);
        const TexelRect all{0, 0, desc.size, desc.size};
        EXPECT_NEAR(statistics(with.lighting, all).mean / statistics(without.lighting, all).mean, 1.0, 0.01)
            << name;
    }
}

TEST(FootprintTracers, Agree) {
    const Scene scene = generateScene("cornell_geom");
    const BakeDesc desc{.size = 128, .passes = 3, .method = Method::Hybrid, .samples = 16, .footprint = true};
    expectTracersAgree(scene, desc, 5e-3);
}

// The error is measured against many directions without footprints.
TEST(FootprintError, IsLessWithFewDirections) {
    struct Scenes {
        const char* name;
        Scene scene;
        Method method;
        double most; // of the error without
    };
    const Scenes scenes[] = {{"stripes", stripedRoom(128), Method::Directional, 0.7},
                             {"cornell_small", generateScene("cornell_small"), Method::Hybrid, 0.99},
                             {"cornell_geom", generateScene("cornell_geom"), Method::Hybrid, 0.99}};
    for (const Scenes& s : scenes) {
        BakeDesc desc{.size = 128, .passes = 3, .method = s.method, .samples = 1024};
        const Baked reference = bakeScene(s.scene, desc);
        desc.samples = 16;
        const double without = relativeError(bakeScene(s.scene, desc).lighting, reference.lighting);
        desc.footprint = true;
        const double with = relativeError(bakeScene(s.scene, desc).lighting, reference.lighting);
        EXPECT_LT(with, s.most * without) << s.name;
        RecordProperty(s.name, std::to_string(with / without));
    }
}

// The same directions are used with and without footprints: with four times as many directions a quarter of
// the area is filtered over.
TEST(FootprintError, FallsWithTheDirections) {
    const Scene scene = generateScene("cornell_small");
    double before = 1.0;
    for (const uint32_t samples : {16u, 64u, 256u, 1024u}) {
        BakeDesc desc{.size = 64, .passes = 3, .method = Method::Hybrid, .samples = samples};
        const Baked without = bakeScene(scene, desc);
        desc.footprint = true;
        const double apart = relativeError(bakeScene(scene, desc).lighting, without.lighting);
        EXPECT_GT(apart, 0.0);
        EXPECT_LT(apart, 0.6 * before) << samples;
        before = apart;
    }
}

// Where the error decides how many directions there are, sample passes begin with wide footprints.
TEST(FootprintError, FallsFromSamplePassToSamplePass) {
    const Scene scene = generateScene("cornell_small");
    double before = 1.0;
    for (const double error : {0.1, 0.02, 0.005}) {
        BakeDesc desc{.size = 64, .passes = 0, .error = error, .method = Method::Hybrid};
        const Baked without = bakeScene(scene, desc);
        desc.footprint = true;
        const double apart = relativeError(bakeScene(scene, desc).lighting, without.lighting);
        EXPECT_LT(apart, before) << error;
        EXPECT_LT(apart, 2.0 * error);
        before = apart;
    }
}

} // namespace relume
